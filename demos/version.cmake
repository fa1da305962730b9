# SPDX-License-Identifier: GPL-3.0-or-later
# Run at build time: writes OUT, which defines pinchlab::version, from VERSION and the sources in ROOT.
file(GLOB sources RELATIVE ${ROOT} ${ROOT}/sim/*.cpp ${ROOT}/sim/*.h ${ROOT}/render/*.cpp ${ROOT}/render/*.h
  ${ROOT}/demos/*.cpp ${ROOT}/demos/*.h)
list(SORT sources)
set(hashes "")
foreach(source ${sources})
  file(SHA256 ${ROOT}/${source} hash)
  string(APPEND hashes "${hash} ${source}\n")
endforeach()
string(SHA256 hash "${hashes}")
string(SUBSTRING ${hash} 0 12 hash)
file(WRITE ${OUT} "#include \"demos/version.h\"\nconst char* const pinchlab::version = \"${VERSION}+${hash}\";\n")
