# Writes a C++ file with the text of every source that NVRTC compiles. FILES: "name=path" pairs.
set(entries "")
foreach(pair ${FILES})
  string(FIND "${pair}" "=" equals)
  string(SUBSTRING "${pair}" 0 ${equals} name)
  math(EXPR start "${equals} + 1")
  string(SUBSTRING "${pair}" ${start} -1 path)
  file(READ ${path} text)
  string(APPEND entries "    {\"${name}\", R\"ptbench(${text})ptbench\"sv},\n")
endforeach()
file(WRITE ${OUTPUT}.new "#include \"variants/cuda/sources.h\"

namespace pt::cuda {

using namespace std::string_view_literals;  // their lengths are known: the compiler need not count a megabyte

std::span<const EmbeddedSource> embedded_sources() {
    static constexpr EmbeddedSource sources[] = {
${entries}    };
    return sources;
}

}  // namespace pt::cuda
")
file(RENAME ${OUTPUT}.new ${OUTPUT})
