# Builds `tet` with TETFMT_BUILD_CONVERT=OFF where CMake cannot find the heavy packages, then looks at what was
# included and linked: their headers lie on the compiler's default path, so a stray #include would go unnoticed.
execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK} -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${CXX}
          -DCMAKE_CXX_FLAGS=${CXX_FLAGS} -DCMAKE_BUILD_TYPE=${BUILD_TYPE} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}
          -DTETFMT_WERROR=${WERROR} -DTETFMT_BUILD_CONVERT=OFF -DTETFMT_BUILD_TESTS=OFF
          -DCMAKE_DISABLE_FIND_PACKAGE_CGAL=ON -DCMAKE_DISABLE_FIND_PACKAGE_draco=ON
          -DCMAKE_DISABLE_FIND_PACKAGE_tinyobjloader=ON -DCMAKE_DISABLE_FIND_PACKAGE_GMP=ON
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK} COMMAND_ERROR_IS_FATAL ANY)

set(heavy "(CGAL/|tetgen[.]h|draco/|tiny_obj_loader|OpenMesh/|libtet[.]so|libdraco|libtinyobj|libgmp|libmpfr)")
if(GENERATOR STREQUAL "Ninja")
  execute_process(COMMAND ninja -C ${WORK} -t deps OUTPUT_VARIABLE used COMMAND_ERROR_IS_FATAL ANY)
  if(NOT used MATCHES "validate[.]hpp")
    message(FATAL_ERROR "the list of included files is not one: ${used}")
  endif()
  if(used MATCHES "[^\n]*${heavy}[^\n]*")
    message(FATAL_ERROR "included without the converter: ${CMAKE_MATCH_0}")
  endif()
endif()
execute_process(COMMAND ldd ${WORK}/tools/tet/tet OUTPUT_VARIABLE linked COMMAND_ERROR_IS_FATAL ANY)
if(linked MATCHES "[^\n]*${heavy}[^\n]*")
  message(FATAL_ERROR "linked without the converter: ${CMAKE_MATCH_0}")
endif()

execute_process(COMMAND ${WORK}/tools/tet/tet convert in.off -o out.tet RESULT_VARIABLE status ERROR_VARIABLE message)
if(NOT status EQUAL 5)
  message(FATAL_ERROR "tet convert must be unsupported (5) here, not ${status}: ${message}")
endif()
execute_process(COMMAND ${WORK}/tools/tet/tet validate ${WORK}/CMakeCache.txt RESULT_VARIABLE status ERROR_QUIET)
if(NOT status EQUAL 3)
  message(FATAL_ERROR "tet validate of a text file must be invalid (3), not ${status}")
endif()
