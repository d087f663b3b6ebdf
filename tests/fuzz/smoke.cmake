# Runs HARNESS for RUNS inputs of at most MAX_LENGTH bytes, on seed files that SEEDS (if any) writes into WORK.
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})
if(SEEDS)
  execute_process(COMMAND ${SEEDS} ${WORK} COMMAND_ERROR_IS_FATAL ANY)
endif()
execute_process(COMMAND ${HARNESS} ${WORK} -runs=${RUNS} -seed=20 -max_len=${MAX_LENGTH} -timeout=20
                        -rss_limit_mb=1024 -print_final_stats=1 -artifact_prefix=${WORK}/
                COMMAND_ERROR_IS_FATAL ANY)
