# shellcheck shell=bash disable=SC2154 # what ./run and its other parts set
# Part of ./run: installs required packages from the distribution and from PyPI.

requirements=$root/analysis/requirements.txt

cuda_roots() {
    local path
    for path in "${CUDA_HOME:-}" "${CUDA_PATH:-}" /usr/local/cuda /usr/local/cuda-*; do
        [[ -n $path && -d $path ]] && printf '%s\n' "$path"
    done
    return 0
}

find_nvcc() {
    local cuda
    command -v "${CUDACXX:-nvcc}" && return
    while IFS= read -r cuda; do
        [[ -x $cuda/bin/nvcc ]] && printf '%s\n' "$cuda/bin/nvcc" && return
    done < <(cuda_roots)
    return 0
}

# Prints the folder of the CUDA toolkit's own Thrust; nothing where there is none.
find_cuda_thrust() {
    local cuda include
    while IFS= read -r cuda; do
        for include in "$cuda"{,/targets/*}/include{/cccl,}; do
            [[ -f $include/thrust/version.h ]] && printf '%s\n' "$include" && return
        done
    done < <(
        cuda_roots
        [[ -z $nvcc ]] || dirname -- "$(dirname -- "$(readlink -f -- "$nvcc")")"
    )
    return 0
}

# Prints a Python interpreter that is new enough (analysis/requirements.txt) and can make virtual environments.
find_python() {
    local python check='import ensurepip, sys, venv; sys.exit(sys.version_info < (3, 10))'
    for python in python3 /usr/bin/python3; do
        "$python" -c "$check" 2>/dev/null && command -v "$python" && return
    done
    return 0
}

is_installed() { # is_installed PACKAGE
    # shellcheck disable=SC2016  # the ${..} is dpkg-query's
    dpkg-query -W -f='${db:Status-Status}\n' "$1" 2>/dev/null | grep -x installed >/dev/null
}

missing_packages() {
    local tool package
    for tool in g++:"${CXX:-g++}" cmake:cmake ninja-build:ninja git:git python3:python3; do
        command -v "${tool#*:}" >/dev/null || printf '%s\n' "${tool%%:*}"
    done
    [[ -n $(find_python) ]] || printf 'python3-venv\n'
    local libraries=(libbenchmark-dev libgtest-dev libglm-dev nlohmann-json3-dev libcli11-dev libstb-dev libfmt-dev)
    [[ -n $cuda_thrust ]] || libraries+=(libthrust-dev)
    for package in "${libraries[@]}"; do
        is_installed "$package" || printf '%s\n' "$package"
    done
}

# Puts the command that lets apt-get run as root into the array `as_root`; fails where there is none.
become_root() {
    as_root=(env DEBIAN_FRONTEND=noninteractive)
    [[ $(id -u) != 0 ]] || return 0
    command -v sudo >/dev/null || return 1
    if sudo -n true 2>/dev/null; then
        as_root=(sudo -n "${as_root[@]}")
    elif [[ -t 0 && -t 2 && -z ${CI:-} ]]; then
        as_root=(sudo "${as_root[@]}")
    else
        return 1
    fi
}

setup_packages() {
    local missing as_root log=$build_dir/setup.log
    [[ ${PTBENCH_PACKAGES:-} != skip ]] || return 0
    if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
        [[ -f $build_dir/build.ninja ]] || say "no apt-get here: CMake will say which libraries are missing"
        return
    fi
    mapfile -t missing < <(missing_packages)
    ((${#missing[@]})) || return 0
    become_root || die 2 "install with: apt-get install -y ${missing[*]}"
    say "installing ${missing[*]}"
    mkdir -p -- "$build_dir"
    # apt-get update may fail and still leave usable package lists, so only apt-get install decides.
    "${as_root[@]}" apt-get -q -o DPkg::Lock::Timeout=300 update >>"$log" 2>&1 </dev/null || true
    quietly 3 "apt-get install" "$log" \
        "${as_root[@]}" apt-get -q -o DPkg::Lock::Timeout=300 install -y --no-install-recommends "${missing[@]}"
}

# Installs packages for tests that can be skipped. If that fails, the caller tells what is skipped.
try_to_install() { # try_to_install PACKAGE..
    local as_root log=$build_dir/setup.log install
    [[ ${PTBENCH_PACKAGES:-} != skip ]] || return 1
    command -v apt-get >/dev/null && become_root || return 1
    say "installing $*"
    install=("${as_root[@]}" apt-get -q -o DPkg::Lock::Timeout=300 install -y --no-install-recommends "$@")
    "${install[@]}" >>"$log" 2>&1 </dev/null && return
    # The package lists may be older than the mirrors' contents.
    "${as_root[@]}" apt-get -q -o DPkg::Lock::Timeout=300 update >>"$log" 2>&1 </dev/null || true
    "${install[@]}" >>"$log" 2>&1 </dev/null
}

# Installs packages for optional features of the program, tried once per build folder, as not every system has them.
setup_optional() { # setup_optional WITHOUT_IT PACKAGE..
    local without=$1 package stamp=$build_dir/without-$2
    shift
    [[ ${PTBENCH_PACKAGES:-} != skip && ! -e $stamp ]] || return 0
    for package in "$@"; do
        is_installed "$package" || command -v "$package" >/dev/null || {
            try_to_install "$@" && return
            say "no $1: $without"
            mkdir -p -- "$build_dir"
            touch -- "$stamp"
            return
        }
    done
}

# Installs a browser for the tests of the report's page, which are skipped where the system has no such package.
setup_browser() {
    command -v chromium >/dev/null || try_to_install chromium ||
        say "no chromium: tests that look at a page in a browser are skipped (install with: apt-get install -y chromium)"
}

setup_python() {
    install_requirements
    install_package
}

# The stamp file is written last, so that a virtual environment whose making was interrupted is made again.
install_requirements() {
    local python stamp=$venv/ptbench-requirements.sha256 log=$build_dir/setup.log wanted
    wanted=$(sha256sum <"$requirements")
    [[ -f $stamp && $(<"$stamp") == "$wanted" ]] && "$venv/bin/python" -c '' 2>/dev/null && return
    python=$(find_python)
    [[ -n $python ]] || die 2 "found no Python 3.10 or newer with venv (package python3-venv)"
    say "installing the Python packages of analysis/requirements.txt"
    rm -rf -- "$venv"
    quietly 3 "python3 -m venv" "$log" "$python" -m venv "$venv"
    quietly 3 "pip install" "$log" \
        "$venv/bin/python" -m pip install --disable-pip-version-check --no-input -r "$requirements"
    printf '%s\n' "$wanted" >"$stamp.partial"
    mv -- "$stamp.partial" "$stamp"
}

# Installs ptbench's Python package in editable form, without network, so that `python -m ptbench` works anywhere.
install_package() {
    local stamp=$venv/ptbench-package.sha256 log=$build_dir/setup.log wanted
    wanted=$({ printf '%s\n' "$root" && cat -- "$root/pyproject.toml"; } | sha256sum)
    [[ -f $stamp && $(<"$stamp") == "$wanted" ]] && return
    quietly 3 "pip install of the package ptbench" "$log" "$venv/bin/python" -m pip install \
        --disable-pip-version-check --no-input --no-build-isolation --no-deps --editable "$root"
    printf '%s\n' "$wanted" >"$stamp"
}

setup_compilers() {
    nvcc=$(find_nvcc)
    cuda_thrust=$(find_cuda_thrust)
    setup_packages
    setup_optional "what was compiled in another folder is compiled again" ccache
    setup_optional "this build reads no .glb meshes" libtinygltf-dev
    setup_optional "this build imports no scenes in Mitsuba's XML" libpugixml-dev
    setup_optional "this build has no accelerators embree and embree_native" libembree-dev
    setup_optional "this build writes no .exr images" libopenexr-dev
    setup_optional "this build does not run on several hosts by mpirun" libopenmpi-dev openmpi-bin
    [[ -n $nvcc ]] || say "no nvcc found: CPU backend only"
}

setup() {
    setup_compilers
    setup_python
}
