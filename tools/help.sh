# SPDX-License-Identifier: MIT
# Sourced by the shell scripts, in any POSIX shell: what `--help` does, and where results and pages go. `root` is the top
# of the tree, where a script has set it.

unset CDPATH # `cd` would look elsewhere, and print where it has gone

# help_or_go_on WORD...: where one of the words is -h or --help, print the comment at the head of the
# running script and end it. The first line, the licence and lines for a scheduler are left out.
help_or_go_on() {
  for word; do
    case $word in
    -h | --help)
      awk 'NR == 1 || /^# SPDX/ || /^#SBATCH/ { next } !/^#/ { exit } { sub(/^# ?/, ""); print }' <"$0"
      exit 0
      ;;
    esac
  done
}

# Results and the pages made of them.
results=${root:-.}/results
# shellcheck disable=SC2034  # for the scripts that source this
pages=$results/doc
