# SPDX-License-Identifier: MIT
# Sourced by the scripts beside it: what run_folder.sh and sweep.sh check before they write a list for run_list.sh.

# check_words TEXT...: the lists have a line for each run and tabs between its fields, so that neither may
# be in a name, a value or an option; other control characters would spoil what is printed.
check_words() {
  for word; do
    case $word in
    *[[:cntrl:]]*)
      printf '%s: has a line feed, a tab or another control character: rename it (nothing has run)\n' \
        "$(printf '%s' "$word" | LC_ALL=C tr '\000-\037\177' '?')" >&2
      exit 2
      ;;
    esac
  done
}

# own OUT WHAT: OUT becomes the folder for the runs of WHAT, a deck or a folder of decks. One that holds
# those of another, which is still there, would lose them.
own() {
  mkdir -p "$1" || exit 2
  here_now=$(cd "$(dirname "$2")" && pwd)/$(basename "$2")
  held=$(cat "$1/source.txt" 2>/dev/null || :)
  if [ -n "$held" ] && [ -e "$held" ] && ! [ "$held" -ef "$2" ]; then
    echo "$1: holds the runs of $held, not of $2: name another folder, or remove it (nothing has run)" >&2
    exit 2
  fi
  [ "$held" = "$here_now" ] || printf '%s\n' "$here_now" >"$1/source.txt"
}

# distinct: lines "name TAB longer name TAB rest" become "name TAB rest", with names that differ even where
# a file system takes A for a. A name that no other line has stays; where lines share one, and where it is
# that of a file of the batch, the longer one is taken, with a number behind it where that is taken too.
distinct() {
  LC_ALL=C awk -F '\t' '
    BEGIN { split("list.txt summary.csv source.txt compared", files, " "); for (i in files) used[files[i]] = 1 }
    { short[NR] = $1; long[NR] = $2; rest[NR] = substr($0, length($1) + length($2) + 3); n[tolower($1)]++ }
    END {
      for (i = 1; i <= NR; i++) if (n[tolower(short[i])] == 1 && !(tolower(short[i]) in used)) {
        name[i] = short[i]; used[tolower(short[i])] = 1 }
      for (i = 1; i <= NR; i++) if (!(i in name)) {
        word = long[i]
        for (k = 2; tolower(word) in used; k++) word = long[i] "-" k
        name[i] = word; used[tolower(word)] = 1 }
      for (i = 1; i <= NR; i++) print name[i] "\t" rest[i] }'
}

# files_of: reads paths of decks and writes for each its path behind an =, then behind a + each what it includes, directly
# or not, where the program would find it (as named, in the folders of *INCLUDE_PATH, beside the file that includes it).
# What is no file, such as a pipe, which would be waited for, is left to the program.
files_of() {
  LC_ALL=C awk '
    function is_there(path,   word) {
      if (!(path in known)) { word = path; gsub("\047", "\047\\\\\047\047", word); known[path] = !system("[ -f \047" word "\047 ]") }
      return known[path] }
    function find(name, beside,   i) {
      if (name == "-") name = "./-" # awk would read the standard input
      if (is_there(name)) return name
      if (name ~ /^\//) return ""
      for (i = 1; i <= n_folder; i++) {
        if (is_there(folder[i] "/" name)) return folder[i] "/" name
        if (is_there(main folder[i] "/" name)) return main folder[i] "/" name }
      return is_there(beside name) ? beside name : "" }
    function read(path, mark,   line, word, on, name, beside, found, kept) {
      if (path in seen) return
      seen[path] = 1
      print mark path
      beside = path; sub(/[^\/]*$/, "", beside)
      kept = n_folder
      while ((getline line <path) > 0) {
        sub(/[ \t\r]+$/, "", line)
        if (line ~ /^\$/) continue
        if (line ~ /^\*/) {
          split(toupper(line), word, /[ \t,]/)
          if (word[1] == "*END") break
          on = word[1] == "*INCLUDE" ? 1 : word[1] ~ /^\*INCLUDE_PATH(_RELATIVE)?$/ ? 2 : 0
          name = ""
          continue }
        if (!on) continue
        sub(/^[ \t]+/, "", line)
        if (line ~ / \+$/) { sub(/ +\+$/, "", line); name = name line; continue }
        name = name line
        if (name != "" && on == 2) folder[++n_folder] = name
        if (name != "" && on == 1 && (found = find(name, beside)) != "") read(found, "+")
        name = "" }
      close(path)
      n_folder = kept }
    { split("", seen); n_folder = 0; main = $0; sub(/[^\/]*$/, "", main); read($0, "=") }'
}
