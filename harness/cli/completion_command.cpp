#include <fmt/format.h>

#include "harness/cli/commands.h"
#include "harness/cli/completion.h"

namespace pt {

namespace {

constexpr const char* script =
    R"SCRIPT(# Completion of ptbench's command line in bash, and in zsh through bashcompinit. In a shell, or in its start-up file:
#   source <(build/ptbench completion bash)
if [[ -n ${ZSH_VERSION-} ]]; then
    typeset -f compdef >/dev/null || { autoload -U +X compinit && compinit; }
    autoload -U +X bashcompinit && bashcompinit
fi
_ptbench() {
    local line=${COMP_LINE:0:$COMP_POINT} word IFS=$'\n'
    COMPREPLY=($("${1/#\~/$HOME}" completion words "$line" 2>/dev/null))
    # bash completes what follows a word's last "=".
    word=${line##*[[:space:]]}
    if [[ -z ${ZSH_VERSION-} && $COMP_WORDBREAKS == *=* && $word == *=* ]]; then
        COMPREPLY=("${COMPREPLY[@]#"${word%=*}="}")
    fi
    if [[ ${#COMPREPLY[@]} == 1 && ${COMPREPLY[0]} == *= ]]; then
        compopt -o nospace 2>/dev/null
    fi
    return 0
}
# zsh has no compopt: no space there after any word, rather than one after AXIS=.
complete -o default ${ZSH_VERSION:+-o} ${ZSH_VERSION:+nospace} -F _ptbench ptbench
)SCRIPT";

struct CompletionArguments {
    std::string what;
    std::string line;
};

int run(const CompletionArguments& arguments, const CLI::App& app) {
    if (arguments.what == "words") {
        for (const std::string& word : completions(app, arguments.line)) {
            fmt::print("{}\n", word);
        }
    } else if (arguments.what == "bash" && arguments.line.empty()) {
        fmt::print("{}", script);
    } else {
        throw InputError("completion", "argument", "\"" + arguments.what + "\"",
                         "bash (for zsh too), or words and a command line");
    }
    return exit_good;
}

}  // namespace

Command add_completion_command(CLI::App& app) {
    auto arguments = std::make_shared<CompletionArguments>();
    CLI::App* command =
        app.add_subcommand("completion", "Completion for a shell: source <(ptbench completion bash), in zsh too");
    command->add_option("WHAT", arguments->what, "bash: the script; words: what may follow LINE, for the script")
        ->required();
    command->add_option("LINE", arguments->line, "A command line up to the cursor");
    return [arguments, &app] { return run(*arguments, app); };
}

}  // namespace pt
