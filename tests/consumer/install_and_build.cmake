# Library -> WORK/prefix, then tests/consumer/example against that prefix alone, then runs it.
file(REMOVE_RECURSE ${WORK})
set(common -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${CXX_FLAGS} -DCMAKE_BUILD_TYPE=${BUILD_TYPE}
           -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER})

execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/library ${common} -DBUILD_SHARED_LIBS=${SHARED}
                        -DTETFMT_WERROR=${WERROR} -DTETFMT_BUILD_TOOLS=OFF -DTETFMT_BUILD_TESTS=OFF
                        -DCMAKE_INSTALL_PREFIX=${WORK}/prefix
                COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/library --target install COMMAND_ERROR_IS_FATAL ANY)

# Only the prefix may be needed: neither this source tree nor the headers that the library compiled in.
file(GLOB_RECURSE configs ${WORK}/prefix/*.cmake)
foreach(config ${configs})
  file(READ ${config} text)
  foreach(word ${SOURCE} Boost xxhash hwy tetfmt_flags)
    string(FIND "${text}" "${word}" at)
    if(NOT at EQUAL -1)
      message(FATAL_ERROR "${config} names ${word}")
    endif()
  endforeach()
endforeach()

execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE}/tests/consumer/example -B ${WORK}/example ${common}
                        -DCMAKE_PREFIX_PATH=${WORK}/prefix
                COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/example COMMAND_ERROR_IS_FATAL ANY)

set(file ${WORK}/made.tet)
execute_process(COMMAND ${WORK}/example/make_file ${file} COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${WORK}/example/first_hit ${file} OUTPUT_VARIABLE output COMMAND_ERROR_IS_FATAL ANY)
if(NOT output STREQUAL "triangle 0 at t = 2, seen from its front\nlit\n")
  message(FATAL_ERROR "first_hit printed: ${output}")
endif()
execute_process(COMMAND ${WORK}/example/first_hit ${WORK}/no-such-file.tet RESULT_VARIABLE status ERROR_VARIABLE message)
if(NOT status EQUAL 3 OR NOT message MATCHES "1001")
  message(FATAL_ERROR "a missing file gave status ${status}: ${message}")
endif()
