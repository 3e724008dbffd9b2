# Completion of docent and docent-robot for bash: commands and options as `--help` lists them, then files.

_docent_words() {  # COMMAND... : the options and commands of that command
  COLUMNS=400 "$@" --help 2>/dev/null | sed -n \
    -e 's/^  -[a-z], \(--[a-z-]*\).*/\1/p' -e 's/^  \(--[a-z-]*\).*/\1/p' -e 's/^  \([a-z][a-z]*\)  .*/\1/p'
}

_docent_values() {  # OPTION COMMAND... : the choices of an option, if it has any
  local option=$1
  shift
  COLUMNS=400 "$@" --help 2>/dev/null | sed -n "s/^  .*$option {\([^}]*\)}.*/\1/p" | tr ',' ' '
}

_docent() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}
  local command=("${COMP_WORDS[0]}") word
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    case $word in
      -*) break ;;
      *[!a-z]*) break ;;
    esac
    # A word that is no command of the one before is an argument.
    _docent_words "${command[@]}" | grep -qxF -e "$word" || break
    command+=("$word")
  done
  COMPREPLY=()
  if [[ $previous == --* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_docent_values "$previous" "${command[@]}")" -- "$current")
    [ ${#COMPREPLY[@]} -eq 0 ] || return 0
  fi
  mapfile -t COMPREPLY < <(compgen -W "$(_docent_words "${command[@]}")" -- "$current")
  if [ ${#COMPREPLY[@]} -eq 0 ] || [ ${#command[@]} -gt 1 ] && [[ $current != -* ]]; then
    compopt -o filenames 2>/dev/null
    local file
    while IFS= read -r file; do COMPREPLY+=("$file"); done < <(compgen -f -- "$current")
  fi
}
complete -F _docent docent docent-robot
