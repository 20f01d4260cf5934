#include "graphdrl/report/event_writer.h"

#include <fmt/format.h>
#include <unistd.h>

#include <boost/crc.hpp>
#include <chrono>

#include "event.pb.h"

namespace graphdrl {
namespace {

// TFRecord's checksum: CRC-32C, rotated and offset, so that a checksum of checksums stays sound.
std::uint32_t masked_crc(std::string_view data) {
  boost::crc_optimal<32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, true, true> crc;
  crc.process_bytes(data.data(), data.size());
  const std::uint32_t value = crc.checksum();
  return ((value >> 15) | (value << 17)) + 0xa282ead8U;
}

double now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

// Of a name that no other file of the folder has: TensorBoard reads them in order of name, hence of time.
AppendedFile new_file(const std::filesystem::path& folder) {
  char host[256] = "localhost";
  gethostname(host, sizeof host - 1);
  const auto seconds = static_cast<std::int64_t>(now_s());
  for (int n = 0;; ++n) {
    const std::string name = fmt::format("events.out.tfevents.{:010}.{}.{}.{}", seconds, host, getpid(), n);
    if (auto file = AppendedFile::create(folder / name)) return std::move(*file);
  }
}

}  // namespace

EventWriter::EventWriter(const std::filesystem::path& folder, std::int64_t first_step) : file_(new_file(folder)) {
  tensorboard::Event version;
  version.set_wall_time(now_s());
  version.set_file_version("brain.Event:2");
  write_record(version.SerializeAsString());
  tensorboard::Event start;
  start.set_wall_time(now_s());
  start.set_step(first_step);
  start.mutable_session_log()->set_status(tensorboard::SessionLog::START);
  write_record(start.SerializeAsString());
}

void EventWriter::write(std::int64_t step, std::span<const Scalar> scalars) {
  tensorboard::Event event;
  event.set_wall_time(now_s());
  event.set_step(step);
  for (const Scalar& scalar : scalars) {
    auto* const value = event.mutable_summary()->add_value();
    value->set_tag(scalar.tag);
    value->set_simple_value(static_cast<float>(scalar.value));
  }
  write_record(event.SerializeAsString());
}

void EventWriter::write_record(const std::string& record) {
  const auto bytes_of = [](const auto& number) {
    return std::string_view(reinterpret_cast<const char*>(&number), sizeof number);
  };
  const std::uint64_t length = record.size();
  const std::uint32_t length_crc = masked_crc(bytes_of(length));
  const std::uint32_t record_crc = masked_crc(record);
  std::string framed(bytes_of(length));
  framed += bytes_of(length_crc);
  framed += record;
  file_.append(framed += bytes_of(record_crc));
}

}  // namespace graphdrl
