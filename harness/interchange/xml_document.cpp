#include "harness/interchange/xml_document.h"

#include <algorithm>

#include <fmt/format.h>

#ifdef PTBENCH_HAS_PUGIXML
#include <pugixml.hpp>
#endif

namespace pt {

const std::string* XmlElement::attribute(const std::string& name) const {
    const auto found =
        std::find_if(attributes.begin(), attributes.end(), [&](const auto& member) { return member.first == name; });
    return found == attributes.end() ? nullptr : &found->second;
}

std::string XmlElement::value_of(const std::string& name) const {
    const std::string* value = attribute(name);
    return value == nullptr ? "" : *value;
}

std::string XmlElement::text() const {
    constexpr std::size_t longest = 120;
    std::string text = "<" + tag;
    for (const auto& [name, value] : attributes) {
        text += fmt::format(" {}=\"{}\"", name, value);
        if (text.size() > longest) {
            return text.substr(0, longest) + "..";
        }
    }
    return text + ">";
}

#ifdef PTBENCH_HAS_PUGIXML

namespace {

class XmlTreeReader {
public:
    XmlTreeReader(const std::string& text, ImportFindings& problems) : problems_(&problems) {
        for (std::size_t i = 0; i < text.size(); ++i) {
            if (text[i] == '\n') {
                line_ends_.push_back(i);
            }
        }
    }

    std::size_t line_at(std::ptrdiff_t offset) const {
        const auto before =
            std::lower_bound(line_ends_.begin(), line_ends_.end(), static_cast<std::size_t>(std::max(offset, {})));
        return static_cast<std::size_t>(before - line_ends_.begin()) + 1;
    }

    // Converts an XML element with its children; false if the tree is too deep or has too many elements.
    bool read(const pugi::xml_node& node, int depth, XmlElement& element) {
        constexpr int deepest = 64;
        constexpr std::size_t most_elements = 1000000;
        element.tag = node.name();
        element.line = line_at(node.offset_debug());
        if (depth > deepest || ++count_ > most_elements) {
            problems_->add(element.line, "found elements without end, allowed: at most 64 levels and 10^6 elements");
            return false;
        }
        for (const pugi::xml_attribute& attribute : node.attributes()) {
            element.attributes.emplace_back(attribute.name(), attribute.value());
        }
        for (const pugi::xml_node& child : node.children()) {
            if (child.type() != pugi::node_element) {
                continue;
            }
            element.children.emplace_back();
            if (!read(child, depth + 1, element.children.back())) {
                return false;
            }
        }
        return true;
    }

private:
    ImportFindings* problems_;
    std::vector<std::size_t> line_ends_;
    std::size_t count_ = 0;
};

}  // namespace

std::optional<XmlElement> read_xml(const std::string& text, ImportFindings& problems) {
    pugi::xml_document document;
    const pugi::xml_parse_result parsed =
        document.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
    XmlTreeReader reader(text, problems);
    if (!parsed) {
        problems.add(reader.line_at(parsed.offset),
                     fmt::format("found what is no XML ({}), allowed: XML 1.0 in UTF-8", parsed.description()));
        return std::nullopt;
    }
    XmlElement root;
    return reader.read(document.document_element(), 0, root) ? std::optional(std::move(root)) : std::nullopt;
}

bool reads_xml() { return true; }

#else

std::optional<XmlElement> read_xml(const std::string&, ImportFindings& problems) {
    problems.add(0, "this build has no reader for XML: install libpugixml-dev and build again");
    return std::nullopt;
}

bool reads_xml() { return false; }

#endif

}  // namespace pt
