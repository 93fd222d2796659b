#include "harness/interchange/xml_text.h"

#include <fmt/format.h>

namespace pt {

std::string xml_escaped(const std::string& text) {
    std::string escaped;
    for (const char c : text) {
        switch (c) {
            case '&':
                escaped += "&amp;";
                break;
            case '<':
                escaped += "&lt;";
                break;
            case '>':
                escaped += "&gt;";
                break;
            case '"':
                escaped += "&quot;";
                break;
            case '\t':
            case '\n':
            case '\r':
                escaped += fmt::format("&#{};", static_cast<int>(c));
                break;
            default:
                escaped += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
        }
    }
    return escaped;
}

void XmlText::start(const std::string& tag, const Attributes& attributes) {
    text_.append(2 * open_.size(), ' ');
    text_ += "<" + tag;
    for (const auto& [name, value] : attributes) {
        text_ += fmt::format(" {}=\"{}\"", name, xml_escaped(value));
    }
}

void XmlText::open(const std::string& tag, const Attributes& attributes) {
    start(tag, attributes);
    text_ += ">\n";
    open_.push_back(tag);
}

void XmlText::close() {
    const std::string tag = open_.back();
    open_.pop_back();
    text_.append(2 * open_.size(), ' ');
    text_ += "</" + tag + ">\n";
}

void XmlText::leaf(const std::string& tag, const Attributes& attributes) {
    start(tag, attributes);
    text_ += "/>\n";
}

}  // namespace pt
