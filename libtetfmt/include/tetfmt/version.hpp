// SPDX-License-Identifier: MIT
#pragma once

#define TETFMT_VERSION "0.1.0"
