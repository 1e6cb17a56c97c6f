#define ABBE_ONCE
#include "factorizations.h"
