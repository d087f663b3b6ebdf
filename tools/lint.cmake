# Targets for people and for CI: `format` rewrites, `format-check` and `tidy` complain. Tools of LLVM 14, the
# version that .clang-format and .clang-tidy were written for; another version formats some lines differently.
find_program(TETFMT_CLANG_FORMAT NAMES clang-format-14)
find_program(TETFMT_RUN_CLANG_TIDY NAMES run-clang-tidy-14)
find_program(TETFMT_CLANG_TIDY NAMES clang-tidy-14)
mark_as_advanced(TETFMT_CLANG_FORMAT TETFMT_RUN_CLANG_TIDY TETFMT_CLANG_TIDY)

set(list_sources git ls-files -z -- "*.cpp" "*.hpp" "*.h")
if(TETFMT_CLANG_FORMAT)
  add_custom_target(format
    COMMAND ${list_sources} | xargs -0 -r ${TETFMT_CLANG_FORMAT} -i
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} VERBATIM)
  add_custom_target(format-check
    COMMAND ${list_sources} | xargs -0 -r ${TETFMT_CLANG_FORMAT} --dry-run --Werror
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} VERBATIM)
endif()
# The library only: it reads untrusted bytes, so it is where a missed case costs most, and it compiles fast
# enough for every run of CI. `run-clang-tidy-14 -p build/dev tools/` does the rest.
if(TETFMT_RUN_CLANG_TIDY AND TETFMT_CLANG_TIDY)
  add_custom_target(tidy
    COMMAND ${TETFMT_RUN_CLANG_TIDY} -quiet -clang-tidy-binary ${TETFMT_CLANG_TIDY} -p ${PROJECT_BINARY_DIR}
            "${PROJECT_SOURCE_DIR}/libtetfmt/src/.*"
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} VERBATIM)
endif()
