// Must not compile: settings does not link recording.
#include "recording/recording.h"
