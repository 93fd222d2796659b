# shellcheck shell=bash disable=SC2154 # what ./run and its other parts set
# Part of ./run: `./run package` makes a folder and an archive that run without network.

package_entries='ptbench|check|gpu_tests|README\.txt|LICENSE|lib|tests|scenes|claims|maps|analysis|results'

# Programs that test the GPU side, which exist if the build has a CUDA backend. A source file may give several, such as
# segments_test and segments_exact_test.
gpu_tests() {
    local source name targets
    targets=$(cmake --build "$build_dir" --target help)
    for source in tests/gpu/*_test.c*; do
        name=${source##*/}
        name=${name%_test.*}
        sed -nE "s/^(${name}(_exact)?_test): phony$/\1/p" <<<"$targets"
    done
}

# Copies a program without its symbols, and the shared libraries that it needs except for glibc's.
pack_program() { # pack_program PROGRAM FOLDER LIB_FOLDER
    local name path package
    strip -o "$2/${1##*/}" "$1"
    while read -r name path; do
        case $name in
        libc.so.* | libm.so.* | libdl.so.* | libpthread.so.* | librt.so.* | ld-linux*) continue ;;
        esac
        [[ ! -e $3/$name ]] || continue
        [[ -f $path ]] || die 1 "${1##*/} needs $name, which is not found"
        install -D -m 644 -- "$path" "$3/$name"
        package=$({ dpkg -S "$(readlink -f -- "$path")" || dpkg -S "*/${path##*/}"; } 2>/dev/null | sed 's/:.*//;q')
        [[ ! -f /usr/share/doc/$package/copyright ]] ||
            install -D -m 644 -- "/usr/share/doc/$package/copyright" "$3/licences/$name.txt"
    done < <(ldd "$1" | sed -nE 's/^\s*(\S+) => (\S+).*/\1 \2/p')
}

# Prints the newest glibc version of which the given binaries need a symbol.
glibc_needed() { # glibc_needed FILE..
    objdump -T -- "$@" | grep -oE 'GLIBC_[0-9.]+' | sort -uV | sed -n '$s/GLIBC_//p'
}

run_package() {
    local out=$root/package architectures=${PTBENCH_PACKAGE_ARCHITECTURES:-90-real;75-virtual} info sha version
    local archive folder foreign test tests glibc gpu_lines="" cuda_lines="" files
    while (($#)); do
        case $1 in
        --out)
            (($# > 1)) || die 2 "--out needs a folder"
            out=$2
            shift
            ;;
        --out=*) out=${1#--out=} ;;
        *) die 2 "'package' takes --out DIR, got '$1'" ;;
        esac
        shift
    done
    [[ -n $out ]] || die 2 "--out needs a folder"
    out=$(realpath -sm -- "$(cd -- "$called_from" && realpath -sm -- "$out")")
    # The output folder is replaced, so it must contain nothing but an earlier package.
    foreign=$(find "$out" -maxdepth 1 -mindepth 1 -printf '%f\n' 2>/dev/null | grep -vxE "$package_entries" | head -n 1) || true
    [[ -n $foreign || ! -d $out/results ]] ||
        foreign=$(find "$out/results" -type f ! -name tuning.json -printf 'results/%P\n' | head -n 1)
    [[ -z $foreign ]] ||
        die 2 "$(shown "$out") holds $foreign, which is no part of a package: move it, or name another folder with --out"
    [[ ! -e $out || -d $out ]] || die 2 "$(shown "$out") is no folder: name another with --out"

    # An existing folder build-portable is reused if it was configured for the same GPUs.
    build_dir=$root/build-portable
    grep -qxF "PTBENCH_CUDA_ARCHITECTURES:STRING=$architectures" "$build_dir/CMakeCache.txt" 2>/dev/null ||
        build_dir=$root/build-package
    setup_compilers
    [[ -z $nvcc ]] || export CUDACXX=$nvcc
    quietly 1 "CMake" "$build_dir/configure.log" cmake --preset portable -S "$root" -B "$build_dir" \
        "-DPTBENCH_CUDA_ARCHITECTURES=$architectures"
    mapfile -t tests < <(gpu_tests)
    build_targets ptbench "${tests[@]}"

    folder=$out.partial
    rm -rf -- "$folder"
    mkdir -p -- "$folder/tests"
    pack_program "$build_dir/ptbench" "$folder" "$folder/lib"
    for test in "${tests[@]}"; do
        pack_program "$build_dir/tests/$test" "$folder/tests" "$folder/lib"
        gpu_lines="  ./gpu_tests                                all tests of the GPU side; writes results/MACHINE/gpu_tests.json"$'\n'
    done
    cp -- LICENSE "$folder/"
    # The package includes the parameters that `ptbench autotune` found, for runs on a machine of an equal name.
    mapfile -t tunings < <(find results -name tuning.json)
    tar -cf - --exclude=__pycache__ scenes claims maps analysis "${tunings[@]}" | tar -xf - -C "$folder"

    mapfile -t files < <(find "$folder" -maxdepth 2 -type f \( -name '*.so*' -o -perm -u+x \))
    glibc=$(glibc_needed "${files[@]}")
    info=$build_dir/generated/build_info.h
    version=$(sed -n 's/#define PTBENCH_VERSION "\(.*\)"/\1/p' "$info")
    sha=$(sed -n 's/#define PTBENCH_GIT_SHA "\(.......\).*"/\1/p' "$info")
    ! grep -qx '#define PTBENCH_GIT_DIRTY 1' "$info" || sha+=-changed
    if ((${#tests[@]})); then
        cuda_lines="For the GPU: an NVIDIA driver for CUDA $(cuda_runtime_version) or newer, libnvrtc and the CUDA headers of 12.8 or newer"$'\n'
        cuda_lines+="(CUDA_HOME says where, else /usr/local/cuda). Thrust and CUB are compiled for $architectures."$'\n'
    fi
    fill_in packaging/check "$folder/check" GLIBC "$glibc" ARCHITECTURES "$architectures"
    fill_in packaging/README.txt "$folder/README.txt" GLIBC "$glibc" VERSION "$version" SHA "$sha" \
        GPU_TESTS "$gpu_lines" CUDA_NEEDS "$cuda_lines"
    chmod 755 "$folder/check"
    ((${#tests[@]} == 0)) || install -m 755 -- packaging/gpu_tests "$folder/"
    check_package "$folder"

    rm -rf -- "$out"
    mv -- "$folder" "$out"
    # The GPU test programs share most of their code, at distances beyond gzip's window, so xz is preferred.
    local ending=tar.xz compress=(xz --threads=1 --lzma2=preset=1,dict=256MiB)
    command -v xz >/dev/null || ending=tar.gz compress=(gzip -9n)
    archive=$(dirname -- "$out")/ptbench-$sha.$ending
    # The archive contains nothing of this machine or time, so that equal packages give equal archives.
    tar -C "$out" --sort=name --owner=0 --group=0 --numeric-owner --mtime=@0 --transform "s,^\.,ptbench-$sha," -cf - . |
        "${compress[@]}" >"$archive.partial"
    mv -- "$archive.partial" "$archive"
    say "package $(shown "$out") ($(du -sm -- "$out" | cut -f1) MiB), for glibc $glibc and newer"
    say "archive $(shown "$archive") ($(du -sm -- "$archive" | cut -f1) MiB)"
}

cuda_runtime_version() {
    local include
    include=$(sed -n 's/^PTBENCH_CUDA_INCLUDE:PATH=//p' "$build_dir/CMakeCache.txt")
    sed -n 's/^#define CUDART_VERSION *\([0-9]*\).*/\1/p' "$include/cuda_runtime_api.h" |
        awk '{ printf "%d.%d", $1 / 1000, $1 % 1000 / 10 }'
}

fill_in() { # fill_in TEMPLATE FILE NAME VALUE..: each @NAME@ by its value
    local text file=$2
    text=$(<"$1")
    shift 2
    while (($#)); do
        text=${text//"@$1@"/"$2"}
        shift 2
    done
    printf '%s\n' "$text" >"$file"
}

# Checks in an empty environment that every library but glibc's comes from lib/, so that the package runs elsewhere.
check_package() { # check_package FOLDER
    local program name path lib
    lib=$(realpath -- "$1/lib")
    for program in "$1/ptbench" "$1"/tests/*; do
        [[ -f $program ]] || continue
        while read -r name path; do
            [[ $name =~ ^lib(c|m|dl|pthread|rt)\.so|^ld-linux || $(realpath -m -- "$path") == "$lib/"* ]] ||
                die 1 "${program##*/} takes $name from $path, not from lib/"
        done < <(env -i PATH=/usr/bin:/bin ldd "$program" | sed -nE 's/^\s*(\S+) => (\S+).*/\1 \2/p')
    done
    env -i PATH=/usr/bin:/bin "$1/ptbench" list >/dev/null || die 1 "the packed ptbench does not start"
}
