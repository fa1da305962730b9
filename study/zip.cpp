// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/zip.h"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <new>
#include <stdexcept>

namespace pinchlab::study {

void ZipWriter::Free::operator()(archive* writer) const {
  archive_write_free(writer);
}

ZipWriter::ZipWriter(const std::filesystem::path& path)
    : partial_(path.string()), writer_(archive_write_new()) {
  if (!writer_) {
    throw std::bad_alloc();
  }
  check(archive_write_set_format_zip(writer_.get()));
  check(archive_write_set_options(writer_.get(), "zip:compression=deflate,zip:hdrcharset=UTF-8"));
  check(archive_write_open_filename(writer_.get(), partial_.name().c_str()));
}

void ZipWriter::check(int result) const {
  if (result != ARCHIVE_OK) {
    const char* why = archive_error_string(writer_.get());
    throw std::runtime_error(fmt::format("{}: cannot be written: {}", partial_.path(),
                                         why == nullptr ? "libarchive does not say why" : why));
  }
}

void ZipWriter::add(const std::string& name, std::string_view bytes) {
  const std::unique_ptr<archive_entry, void (*)(archive_entry*)> entry(archive_entry_new(),
                                                                       &archive_entry_free);
  if (!entry) {
    throw std::bad_alloc();
  }
  archive_entry_set_pathname_utf8(entry.get(), name.c_str());
  archive_entry_set_filetype(entry.get(), AE_IFREG);
  archive_entry_set_perm(entry.get(), 0644);
  archive_entry_set_size(entry.get(), static_cast<la_int64_t>(bytes.size()));
  check(archive_write_header(writer_.get(), entry.get()));
  if (archive_write_data(writer_.get(), bytes.data(), bytes.size()) !=
      static_cast<la_ssize_t>(bytes.size())) {
    check(ARCHIVE_FATAL);
  }
}

void ZipWriter::finish() {
  check(archive_write_close(writer_.get()));
  partial_.keep();
}

}  // namespace pinchlab::study
