# Writes OUTPUT: the text HEAD, then every option of `docent serve` as PROGRAM prints it, for a system service.
set(ENV{COLUMNS} 100)
execute_process(COMMAND ${PROGRAM} serve --print-config --data /var/lib/docent OUTPUT_VARIABLE settings
  COMMAND_ERROR_IS_FATAL ANY)
file(READ ${HEAD} head)
file(WRITE ${OUTPUT} "${head}${settings}")
