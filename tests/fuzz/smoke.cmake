# Fills WORK with seed files by SEEDS, then runs HARNESS on them for RUNS inputs.
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})
execute_process(COMMAND ${SEEDS} ${WORK} COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${HARNESS} ${WORK} -runs=${RUNS} -seed=20 -max_len=16384 -timeout=20 -rss_limit_mb=1024
                        -print_final_stats=1 -artifact_prefix=${WORK}/
                COMMAND_ERROR_IS_FATAL ANY)
