# Writes OUTPUT, the source file that names the version and the commit; at every build, but only where that has changed.
#   cmake -D SOURCE=ROOT_OF_TREE -D VERSION=0.1.0 -D OUTPUT=FILE -P commit.cmake
# The commit is git's; in an archive that `git archive` made, what it put into archived_commit; else it is not named.
file(READ ${CMAKE_CURRENT_LIST_DIR}/archived_commit commit)
string(STRIP "${commit}" commit)
if(commit MATCHES "Format" OR commit STREQUAL "")  # a checkout: nothing was put in
  set(commit "")
  execute_process(COMMAND git -C ${SOURCE} describe --always --exclude=* --abbrev=12 --dirty=,\ changed
    OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  # The tree may lie, without a history of its own, below another one that has one.
  execute_process(COMMAND git -C ${SOURCE} rev-parse --show-toplevel
    OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  file(REAL_PATH "${SOURCE}" source)
  if(failed OR NOT top STREQUAL source)
    set(commit "")
  endif()
endif()
set(version "${VERSION}")
if(commit)
  string(APPEND version " (commit ${commit})")
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/commit.cc.in ${OUTPUT} @ONLY)
