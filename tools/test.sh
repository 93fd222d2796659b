# shellcheck shell=bash disable=SC2154 # what ./run and its other parts set
# Part of ./run: `./run test` runs every test program and check, and counts the results.

passed=0
failed=0
skipped=0
failures=()

fail() { # fail NAME
    failed=$((failed + 1))
    failures+=("$1")
}

ending() { # ending EXIT_CODE
    if (($1 > 128)) && kill -l $(($1 - 128)) >/dev/null 2>&1; then
        printf 'ended by SIG%s' "$(kill -l $(($1 - 128)))"
    else
        printf 'ended with exit code %d' "$1"
    fi
}

# Runs a test program that writes a JUnit report, and stores its exit code and seconds beside the report.
start_cases() { # start_cases REPORT COMMAND..
    local report=$1 status=0 started=$SECONDS
    shift
    rm -f -- "$report" "${report%.xml}.ended"
    { # the outer redirection hides the shell's own word on a crash
        timeout --foreground --kill-after=10 "${PTBENCH_TEST_SECONDS:-1200}" "$@" >"${report%.xml}.log" 2>&1 </dev/null
    } 2>/dev/null || status=$?
    printf '%d %d\n' "$status" $((SECONDS - started)) >"${report%.xml}.ended"
}

# Counts the cases of a program that start_cases ran; a bad exit without a failed case counts as one failure.
count_cases() { # count_cases NAME REPORT
    local name=$1 report=$2 log=${2%.xml}.log status seconds counts last
    read -r status seconds <"${report%.xml}.ended"
    mapfile -t counts < <([[ ! -s $report ]] || "$venv/bin/python" tools/read_report.py "$report")
    if ((${#counts[@]})); then
        passed=$((passed + counts[0]))
        failed=$((failed + counts[1]))
        skipped=$((skipped + counts[2]))
        failures+=("${counts[@]:3}")
        printf '%-28s %5d passed, %d failed, %d skipped (%d s)\n' "$name" "${counts[@]:0:3}" "$seconds"
        ((status == 0 || counts[1] > 0)) && return
    fi
    last=$(sed -n 's/^\[ RUN      \] //p' "$log" | tail -n 1)
    tail -n 30 -- "$log"
    case $status in
    0) fail "$name: left no report" ;;
    124) fail "$name: ran out of time${last:+ in $last}" ;;
    *) fail "$name: $(ending "$status")${last:+ in $last}" ;;
    esac
    printf '%-28s %s\n' "$name" "${failures[-1]#*: }"
}

run_cases() { # run_cases NAME REPORT COMMAND..
    start_cases "${@:2}"
    count_cases "$1" "$2"
}

# Prints a line per test file of a build, NAME PROGRAM; the program finds the file's tests in FLAGS/NAME.flags.
list_tests() { # list_tests BUILD_DIR FLAGS [OPTION..]
    mkdir -p -- "$2"
    python3 tools/test_programs.py "$1/tests" --flags "$2" "${@:3}"
}

# Runs one test file, or pytest, for `./run test`; prints its name when it has ended.
run_one_of_all() { # run_one_of_all NAME [PROGRAM]
    local report=$reports/$1.xml
    if [[ $1 == pytest ]]; then
        start_cases "$report" "$venv/bin/python" -m pytest tests/analysis tests/package "--junitxml=$report"
    else
        start_cases "$report" "$build_dir/tests/$2" "--gtest_flagfile=$reports/flags/$1.flags" "--gtest_output=xml:$report"
    fi
    printf '%s\n' "$1"
}

# Sorts lines that begin with a test's name, the slowest first: one of minutes would run alone if it began last.
slowest_first() {
    local slowest=(compile_test pytest verify_shipped_test inspect_test variants_test covering_test levels_test nvcc_test
        mesh_test new_choice_test next_event_test suite_test)
    awk -v slowest="${slowest[*]}" '
        BEGIN { count = split(slowest, names); for (i in names) rank[names[i]] = i }
        { print ($1 in rank ? rank[$1] : count + 1), $0 }' | sort -ns -k 1,1 | cut -d " " -f 2-
}

# Runs as many test programs at once as there are processors, since most have a single thread.
run_all_cases() {
    local tests name
    tests=$(list_tests "$build_dir" "$reports/flags") || fail "the list of test programs"
    export build_dir venv reports
    export -f run_one_of_all start_cases
    while IFS= read -r name; do
        count_cases "$name" "$reports/$name.xml"
    done < <(printf 'pytest\n%s\n' "$tests" | slowest_first | xargs -P "$jobs" -I{} bash -c 'run_one_of_all {}')
}

run_check() { # run_check NAME COMMAND..
    local name=$1 output
    shift
    if output=$("$@" 2>&1); then
        passed=$((passed + 1))
        printf '%-28s good\n' "$name"
    else
        fail "$name"
        printf '%s\n%-28s failed\n' "$output" "$name"
    fi
}

skip_check() { # skip_check NAME REASON
    skipped=$((skipped + 1))
    printf '%-28s skipped: %s\n' "$1" "$2"
}

check_cpp_format() { # check_cpp_format CLANG_FORMAT; names the files that `./run format` would change
    cpp_files | xargs -0r "$1" --dry-run --Werror 2>&1 | sed -nE 's/^([^:]+):[0-9]+:[0-9]+: error: .*/\1/p' | sort -u
}

# Continuous integration ends a run at 5400 s, so steps that would end later are skipped with a message.
latest_begin=
too_late="the time of this run is over: ./run sanitize"

is_late() { # is_late SECONDS; whether a step that takes so long would end too late
    [[ -n $latest_begin ]] && ((EPOCHSECONDS + $1 > latest_begin))
}

# Runs checks that need clang builds: always in continuous integration (90 minutes), else only with --sanitize.
run_extra_checks() { # run_extra_checks [--sanitize]
    local reason
    if [[ ${CI:-} != true && ${1:-} != --sanitize ]]; then
        skip_check fuzz "takes minutes: ./run fuzz"
        skip_check sanitizers "take many minutes: ./run sanitize"
        return
    fi
    reason=$(without_clang)
    if [[ -n $reason ]] && try_to_install clang lld libomp-dev libclang-rt-dev; then
        reason=$(without_clang)
    fi
    if [[ -n $reason ]]; then
        skip_check fuzz "$reason"
        skip_check sanitizers "$reason"
        return
    fi
    if is_late 1500; then
        skip_check fuzz "$too_late"
        skip_check sanitizers "$too_late"
        return
    fi
    run_check "sanitizers' build" build_sanitized all
    [[ ! -x $root/build-sanitize/fuzz/fuzz_scene ]] || run_check fuzz fuzz_all 30
    sanitize_tests
}

# Prints the failed tests and the counts, and ends.
summary() {
    ((${#failures[@]} == 0)) || printf 'failed: %s\n' "${failures[@]}"
    printf '%d passed, %d failed' "$passed" "$failed"
    ((skipped == 0)) || printf ', %d skipped' "$skipped"
    printf '\n'
    ((failed == 0))
}

run_test() {
    [[ $# -eq 0 || $* == --sanitize ]] || die 2 "'test' takes --sanitize or nothing, got '$*'"
    # Waiting OpenMP threads must not spin, as test programs share the cores. Benchmarks keep OpenMP's default.
    export OMP_WAIT_POLICY=passive
    local reports=$build_dir/test-reports clang_format
    [[ ${CI:-} != true ]] || latest_begin=$((EPOCHSECONDS - SECONDS + 4500))
    build all
    setup_browser
    mkdir -p -- "$reports"
    run_all_cases
    run_extra_checks "$@"
    run_check "ruff check" "$venv/bin/python" -m ruff check "${python_folders[@]}"
    run_check "ruff format" "$venv/bin/python" -m ruff format --check "${python_folders[@]}"
    clang_format=$(find_clang_format)
    if [[ -n $clang_format ]]; then
        run_check clang-format check_cpp_format "$clang_format"
    else
        skip_check clang-format "no clang-format $clang_format_major"
    fi

    summary
}
