# SPDX-License-Identifier: MIT
# Sourced by the shell scripts, in any POSIX shell: what `--help` does.

# help_or_go_on WORD...: where one of the words is -h or --help, print the comment at the head of the
# running script and end it. The first line, the licence and lines for a scheduler are left out.
help_or_go_on() {
  for word; do
    case $word in
    -h | --help)
      awk 'NR == 1 || /^# SPDX/ || /^#SBATCH/ { next } !/^#/ { exit } { sub(/^# ?/, ""); print }' "$0"
      exit 0
      ;;
    esac
  done
}
