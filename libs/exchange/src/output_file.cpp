#include "topogeo/exchange/output_file.hpp"

#include "topogeo/support/atomic_file.hpp"

namespace topogeo::exchange {

void write_files(std::span<const OutputFile> files) {
  for (const OutputFile& file : files) support::write_file_atomically(file.path, file.bytes);
}

}  // namespace topogeo::exchange
