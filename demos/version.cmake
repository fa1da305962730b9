# SPDX-License-Identifier: GPL-3.0-or-later
# Run at build time: writes OUT, which defines pinchlab::version, from VERSION and the sources in ROOT.
foreach(room base sim render demos)
  file(GLOB_RECURSE of_room RELATIVE ${ROOT} ${ROOT}/${room}/*.cpp ${ROOT}/${room}/*.h)
  list(APPEND sources ${of_room})
endforeach()
list(FILTER sources EXCLUDE REGEX "^(base/answer_file|demos/scenes/(build|library))[.]")  # of no clip
list(SORT sources)
set(hashes "")
foreach(source ${sources})
  file(SHA256 ${ROOT}/${source} hash)
  string(APPEND hashes "${hash} ${source}\n")
endforeach()
string(SHA256 hash "${hashes}")
string(SUBSTRING ${hash} 0 12 hash)
file(WRITE ${OUT} "#include \"demos/version.h\"\nconst char* const pinchlab::version = \"${VERSION}+${hash}\";\n")
