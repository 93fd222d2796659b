// Writes XML with elements and attributes only, which is all that exported scenes need, without a library. XML 1.0,
// fifth edition, section 2.4 says what is escaped.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace pt {

// Escapes a text as an XML attribute value in double quotes. Control characters, which XML 1.0 cannot hold, become '?'.
std::string xml_escaped(const std::string& text);

class XmlText {
public:
    using Attributes = std::vector<std::pair<std::string, std::string>>;

    void open(const std::string& tag, const Attributes& attributes);
    void close();
    // Writes an empty XML element.
    void leaf(const std::string& tag, const Attributes& attributes);

    // The XML text written so far; complete once all opened elements are closed.
    const std::string& text() const { return text_; }

private:
    void start(const std::string& tag, const Attributes& attributes);

    std::string text_ = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n";
    std::vector<std::string> open_;
};

}  // namespace pt
