// Writes XML of elements and attributes: all that scene files for other renderers need, so no library is asked for.
// XML 1.0, fifth edition, section 2.4 says what is escaped.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace pt {

// The text as the value of an attribute in double quotes. What XML 1.0 cannot hold, control characters, becomes '?'.
std::string xml_escaped(const std::string& text);

class XmlText {
public:
    using Attributes = std::vector<std::pair<std::string, std::string>>;

    void open(const std::string& tag, const Attributes& attributes);
    void close();
    // An element without content.
    void leaf(const std::string& tag, const Attributes& attributes);

    // The text, which is whole once every element that was opened is closed.
    const std::string& text() const { return text_; }

private:
    void start(const std::string& tag, const Attributes& attributes);

    std::string text_ = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n";
    std::vector<std::string> open_;
};

}  // namespace pt
