# shellcheck shell=bash disable=SC2154 # what ./run and its other parts set
# Part of ./run: `./run fuzz` and `./run sanitize`, the builds with clang.

# Prints why clang builds are impossible on this machine; nothing if they are possible.
without_clang() {
    local tool
    for tool in clang++ ld.lld; do
        command -v "$tool" >/dev/null || {
            printf 'no %s (packages clang, lld, libomp-dev)' "$tool"
            return
        }
    done
    printf 'int main() {}' | clang++ -x c++ -fopenmp -fsanitize=address,undefined -fuse-ld=lld -o /dev/null - 2>/dev/null ||
        printf 'clang++ cannot link OpenMP and the sanitizers (packages libomp-dev, libclang-rt-dev)'
}

# Configures and builds the CMake preset `sanitize`; on failure shows the end of the log and fails.
build_sanitized() { # build_sanitized TARGET..
    local log=$root/build-sanitize/build.log
    mkdir -p -- "${log%/*}"
    { cmake --preset sanitize && cmake --build "$root/build-sanitize" -j "$jobs" --target "$@"; } >"$log" 2>&1 </dev/null &&
        return
    grep -E 'error|FAILED' -- "$log" | head -n 20
    tail -n 20 -- "$log"
    return 1
}

# Fuzzes one reader from the corpus in the repository; new corpus entries and failing inputs stay in the build folder.
# Each commit fuzzes from a seed of its own.
fuzz_one() { # fuzz_one READER SECONDS
    local folder=$root/build-sanitize/found/$1 commit
    commit=$(git rev-parse --short=7 HEAD 2>/dev/null) || commit=1
    mkdir -p -- "$folder/corpus"
    UBSAN_OPTIONS=print_stacktrace=1 "$root/build-sanitize/fuzz/fuzz_$1" -max_total_time="$2" -seed=$((16#${commit:0:7})) -timeout=10 -max_len=4096 \
        -rss_limit_mb=2048 -dict=tests/fuzz/words.dict -artifact_prefix="$folder/" -print_final_stats=1 \
        "$folder/corpus" "tests/fuzz/corpus/$1" >"$folder/log" 2>&1 </dev/null
}

# Fuzzes all readers, as many at a time as there are processors; prints a line with the input for each that fails.
fuzz_all() { # fuzz_all SECONDS
    local target targets=() name status=0
    for target in tests/fuzz/corpus/*/; do
        targets+=("$(basename -- "$target")")
    done
    export root
    export -f fuzz_one
    printf '%s\n' "${targets[@]}" | xargs -P "$jobs" -I{} bash -c 'fuzz_one {} '"$1" || status=1
    for name in "${targets[@]}"; do
        say "fuzzed $name: $(sed -n 's/^stat::number_of_executed_units: *//p' "$root/build-sanitize/found/$name/log") inputs"
        ! grep -qE '^SUMMARY|ERROR: libFuzzer|^fatal' "$root/build-sanitize/found/$name/log" ||
            tail -n 40 -- "$root/build-sanitize/found/$name/log"
    done
    return "$status"
}

run_fuzz() {
    local reason seconds=${1:-60}
    [[ $seconds =~ ^[1-9][0-9]*$ && $# -le 1 ]] || die 2 "'fuzz' takes a whole number of seconds, got '$*'"
    reason=$(without_clang)
    [[ -z $reason ]] || die 2 "cannot fuzz: $reason"
    build_sanitized fuzz || die 1 "the build failed"
    fuzz_all "$seconds" || die 1 "found what ends a reader: the input lies under build-sanitize/found"
}

# Runs one test file of build-sanitize; prints its name when it has ended, or why it did not begin.
run_one_sanitized() { # run_one_sanitized NAME PROGRAM
    local report=$reports/sanitized_$1.xml
    if [[ -n ${latest_begin:-} ]] && ((EPOCHSECONDS > latest_begin)); then
        printf '%s late\n' "$1"
        return
    fi
    UBSAN_OPTIONS=print_stacktrace=1 ASAN_OPTIONS=detect_leaks=1 \
        start_cases "$report" "$root/build-sanitize/tests/$2" "--gtest_flagfile=$reports/sanitized_flags/$1.flags" \
        "--gtest_output=xml:$report"
    printf '%s\n' "$1"
}

# Runs the CPU side's sanitized tests, as many at once as there are processors, the longest last. Tests left out are in
# tests/sanitize_excluded.txt, with reasons. If `latest_begin` is set, none begins after that second.
sanitize_tests() {
    local tests name late
    tests=$(list_tests "$root/build-sanitize" "$reports/sanitized_flags" --excluded tests/sanitize_excluded.txt) ||
        fail "the list of sanitized test programs"
    export root reports latest_begin
    export -f run_one_sanitized start_cases
    while read -r name late; do
        if [[ -n $late ]]; then
            skip_check "sanitized $name" "$too_late"
        else
            count_cases "sanitized $name" "$reports/sanitized_$name.xml"
        fi
    done < <(slowest_first <<<"$tests" | tac | xargs -P "$jobs" -I{} bash -c 'run_one_sanitized {}')
}

run_sanitize() {
    local reason reports=$build_dir/test-reports
    export OMP_WAIT_POLICY=passive
    setup_python
    mkdir -p -- "$reports"
    reason=$(without_clang)
    [[ -z $reason ]] || die 2 "cannot sanitize: $reason"
    build_sanitized all || die 1 "the build failed"
    sanitize_tests
    summary
}
