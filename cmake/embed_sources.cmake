# Writes a C++ file with the text of every source that NVRTC compiles; FILES are "name=path" pairs. The host part at the
# end of a choice's file is left out, so that editing it does not invalidate compiled kernels.
set(entries "")
foreach(pair ${FILES})
  string(FIND "${pair}" "=" equals)
  string(SUBSTRING "${pair}" 0 ${equals} name)
  math(EXPR start "${equals} + 1")
  string(SUBSTRING "${pair}" ${start} -1 path)
  file(READ ${path} text)
  string(FIND "${text}" "\n#if defined(PT_HOST)" host_part)
  if(NOT host_part EQUAL -1)
    string(SUBSTRING "${text}" 0 ${host_part} text)
    string(APPEND text "\n")
  endif()
  string(APPEND entries "    {\"${name}\", R\"ptbench(${text})ptbench\"sv},\n")
endforeach()
file(WRITE ${OUTPUT}.new "#include \"variants/cuda/runtime/sources.h\"

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
