#include "harness/cli/completion.h"

#include <algorithm>
#include <map>
#include <sstream>

#include "harness/cli/commands.h"
#include "harness/cli/known_names.h"
#include "harness/cli/render_aovs.h"
#include "harness/scene/places.h"

namespace pt {

namespace {

using Words = std::vector<std::string>;

Words split_words(const std::string& line) {
    std::istringstream stream(line);
    Words words;
    for (std::string word; stream >> word;) {
        words.push_back(word);
    }
    if (line.empty() || line.back() == ' ' || line.back() == '\t') {
        words.emplace_back();  // a command line that ends in a space is completed by a new word
    }
    return words;
}

Words that_begin_with(const std::string& begun, const Words& known) {
    Words found;
    std::copy_if(known.begin(), known.end(), std::back_inserter(found),
                 [&](const std::string& name) { return name.starts_with(begun); });
    return found;
}

Words with_prefix(const std::string& prefix, Words words) {
    for (std::string& word : words) {
        word.insert(0, prefix);
    }
    return words;
}

Words with_suffix(Words words, const std::string& suffix) {
    for (std::string& word : words) {
        word += suffix;
    }
    return words;
}

Words joined(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

// Completes the last element of a list such as "a,b,c" by names that the list does not contain yet.
Words complete_list(const std::string& begun, const Words& known) {
    const std::size_t comma = begun.rfind(',');
    const std::string before = comma == std::string::npos ? "" : begun.substr(0, comma + 1);
    Words found = that_begin_with(begun.substr(before.size()), known);
    std::erase_if(found,
                  [&](const std::string& name) { return ("," + before).find("," + name + ",") != std::string::npos; });
    return with_prefix(before, found);
}

// The backends whose choices are offered as completions: only the CPU if the command line has "--backend cpu".
BackendSet backends_named(const Words& words) {
    for (std::size_t i = 0; i + 1 < words.size(); ++i) {
        for (const Backend backend : all_backends) {
            const std::string name(to_string(backend));
            if (words[i] == "--backend=" + name || (words[i] == "--backend" && words[i + 1] == name)) {
                return static_cast<BackendSet>(backend);
            }
        }
    }
    return on_every_backend;
}

Words complete_axis(const std::string& begun, BackendSet backends) {
    const std::size_t equals = begun.find('=');
    if (equals == std::string::npos) {
        return that_begin_with(begun, with_suffix(names_of_axes(), "="));
    }
    const std::string axis = begun.substr(0, equals), value = begun.substr(equals + 1);
    Words known = names_of_choices(axis, backends);
    if (!known.empty() && value.find(',') == std::string::npos) {
        known.emplace_back("all");
    }
    return with_prefix(axis + "=", complete_list(value, known));
}

Words complete_value(const std::string& option, const std::string& begun, const Words& words) {
    if (option == "--axis" || option == "--against") {
        return complete_axis(begun, backends_named(words));
    }
    if (option == "--tune") {
        return begun.find('=') == std::string::npos ? that_begin_with(begun, with_suffix(names_of_tunables(), "="))
                                                    : Words();
    }
    if (option == "--scene") {
        return complete_list(begun,
                             joined(scene_names(), begun.find(',') == std::string::npos ? Words{"all"} : Words()));
    }
    if (option == "--suite") {
        return that_begin_with(begun, suite_names());
    }
    if (option == "--backend") {
        return that_begin_with(begun, {"cpu", "cuda"});
    }
    if (option == "--aovs") {
        return complete_list(begun,
                             joined(names_of_aovs(), begun.find(',') == std::string::npos ? Words{"all"} : Words()));
    }
    return option == "--names" ? that_begin_with(begun, joined(names_of_axes(), kinds_of_names)) : Words();
}

Words complete_positional(const std::string& command, const std::string& begun) {
    const std::map<std::string, Words> known{
        {"list", joined(names_of_axes(), {"axes", "features", "scenes", "suites"})},
        {"new", kinds_of_new()},
        {"completion", {"bash"}}};
    const auto names = known.find(command);
    return names == known.end() ? Words() : that_begin_with(begun, names->second);
}

bool takes_value(const CLI::App& command, const std::string& name) {
    const CLI::Option* const option = name.starts_with("--") ? command.get_option_no_throw(name) : nullptr;
    return option != nullptr && option->get_items_expected_max() > 0;
}

bool has_positional(const CLI::App& command) {
    const std::vector<const CLI::Option*> options = command.get_options();
    return std::any_of(options.begin(), options.end(),
                       [](const CLI::Option* option) { return option->get_positional(); });
}

Words complete_in(const CLI::App& command, const Words& words) {
    const std::string &last = words.back(), &before = words[words.size() - 2];
    if (takes_value(command, before)) {
        return complete_value(before, last, words);
    }
    const std::size_t equals = last.find('=');
    if (last.starts_with("--") && equals != std::string::npos) {
        return with_prefix(last.substr(0, equals + 1),
                           complete_value(last.substr(0, equals), last.substr(equals + 1), words));
    }
    if (last.starts_with('-') || (last.empty() && !has_positional(command))) {
        return that_begin_with(last, option_names(command));
    }
    return words.size() == 3 ? complete_positional(command.get_name(), last) : Words();
}

}  // namespace

std::vector<std::string> completions(const CLI::App& app, const std::string& line) {
    const Words words = split_words(line);
    if (words.size() < 2) {
        return {};
    }
    if (words.size() == 2) {
        return that_begin_with(words[1], joined(names_of_commands(app), {"--help", "--version"}));
    }
    const Words commands = names_of_commands(app);
    const bool is_known = std::find(commands.begin(), commands.end(), words[1]) != commands.end();
    return is_known ? complete_in(*app.get_subcommand(words[1]), words) : Words();
}

}  // namespace pt
