// Parses XML 1.0, as far as importers need it, into elements with line numbers; by pugixml if the build has it.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "harness/interchange/import_findings.h"

namespace pt {

struct XmlElement {
    std::string tag;
    std::vector<std::pair<std::string, std::string>> attributes;
    std::vector<XmlElement> children;  // child elements of the XML element; text and comments are left out
    std::size_t line = 0;              // line number of the XML element, from 1

    // The value of an XML attribute; null if there is none of that name.
    const std::string* attribute(const std::string& name) const;
    // The value of an XML attribute; empty if there is none of that name.
    std::string value_of(const std::string& name) const;
    // The XML element's start tag, cut to the length of a message.
    std::string text() const;
};

// Parses an XML text and returns its root element. Returns nothing, after reporting a problem, if the text is not XML
// or is beyond the limits (64 levels, 10^6 elements).
std::optional<XmlElement> read_xml(const std::string& text, ImportFindings& problems);

// Whether the build has pugixml, which parses XML. Without it every text is a problem that says so.
bool reads_xml();

}  // namespace pt
