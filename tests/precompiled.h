// What most tests include from outside abbe, read once for all of them.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <ranges>
#include <regex>
#include <thread>

#include "../cmake/precompiled.h"
