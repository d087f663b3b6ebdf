// SPDX-License-Identifier: MIT
// Which of Highway's targets run here, without a part of Highway that would have to be linked. To be included
// before <hwy/foreach_target.h>, in the places that compile code once a kind of processor (tile.cpp).
#pragma once

// SSSE3 brings nothing over the baseline. Vectors of a length that is not known when compiling cannot be
// members.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_RVV)

namespace tetfmt::detail {

#if defined(__x86_64__)
inline bool has_sse4() {
  __builtin_cpu_init();
  return __builtin_cpu_supports("sse4.2");
}
inline bool has_avx2() {
  __builtin_cpu_init();
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
         __builtin_cpu_supports("bmi2");
}
/// What Highway calls AVX3.
inline bool has_avx512() {
  return has_avx2() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
         __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512cd");
}
#endif

}  // namespace tetfmt::detail
