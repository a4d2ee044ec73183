// SPDX-License-Identifier: MIT
#include "host_bus.h"

struct host_bus host_bus;
