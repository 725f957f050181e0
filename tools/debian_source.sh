# Sources of Debian packages, for other scripts: source it, then fetch_debian_source PACKAGE FOLDER SUITE...

# Tarballs of a package's source, by the first of the suites that has it, into the folder: through the mirror that this
# machine's packages come from, with lists of its own, so that the machine's configuration stays as it is. apt checks
# the signatures. What was said lies in FOLDER/log.
fetch_debian_source() {
  local package=$1 folder=$2 mirror suite apt
  shift 2
  mirror=$(apt-get indextargets --format '$(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' |
    awk -v release="$(debian_release)" '$2 == release && $3 == "main" {print $1; exit}')
  [ -n "$mirror" ] || { echo "no mirror of $(debian_release) main is configured" >"$folder/log"; return 1; }
  mkdir -p "$folder/lists/partial" "$folder/parts"
  apt=(-qq -o "Dir::Etc::sourcelist=$folder/sources.list" -o "Dir::Etc::sourceparts=$folder/parts"
    -o "Dir::State::lists=$folder/lists" -o APT::Sandbox::User=root -o Acquire::Retries=1)
  for suite in "$@"; do
    echo "deb-src $mirror $suite main" >"$folder/sources.list"
    (cd "$folder" && apt-get "${apt[@]}" update && apt-get "${apt[@]}" source --tar-only "$package") >"$folder/log" 2>&1 &&
      ls "$folder/${package}"_*.orig.tar.* >/dev/null 2>&1 && return 0
  done
  return 1
}

# The release that this machine is: bookworm.
debian_release() { (. /etc/os-release && echo "$VERSION_CODENAME"); }
