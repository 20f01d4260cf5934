#include "graphdrl/io/readers.h"

#include <gmock/gmock.h>
#include <zlib.h>

#include "graphdrl/io/file.h"
#include "graphdrl/io/map_source.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string gzipped(const std::string& text) {
  z_stream stream{};
  deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&stream, text.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

std::string as_utf16(std::string_view text, bool big_end_first) {
  std::string bytes;
  for (const char c : text) bytes += big_end_first ? std::string{'\0', c} : std::string{c, '\0'};
  return bytes;
}

// The text of a file with these bytes, and the notes about it.
struct NotedText {
  std::string text;
  std::vector<std::string> notes;
};
NotedText text_of(const std::string& bytes) {
  NotedText result;
  result.text = map_text(bytes, "file", [&](const std::string& note) { result.notes.push_back(note); });
  return result;
}

TEST(MapText, UnpacksGzip) {
  const std::string large(300'000, 'x');
  EXPECT_EQ(text_of(gzipped(large)).text, large);
  EXPECT_EQ(text_of(gzipped("a b\n") + gzipped("b c\n")).text, "a b\nb c\n");  // as pigz and bgzip write
  const TemporaryFolder folder;
  write_file(folder / "two.csv.gz", gzipped("from,to\na,b\n"));
  const NamedMap named = load_map((folder / "two.csv.gz").string());
  EXPECT_EQ(named.name, "two");
  EXPECT_THAT(std::get<GraphMap>(named.map).labels, ElementsAre("a", "b"));
}

TEST(MapText, RefusesWhatUnpacksToFarMore) {
  EXPECT_EQ(text_of(gzipped(std::string(16'000'000, 'x'))).text.size(), 16'000'000U);
  const std::string bomb = gzipped(std::string(20'000'000, 'x'));
  EXPECT_THAT(error_of([&] { text_of(bomb); }), HasSubstr("at most 16777216 bytes unpacked, or the file unpacked"));
  const TemporaryFolder folder;  // eight cells a byte
  write_file(folder / "bits.pbm.gz", gzipped("P4\n8000 8000\n" + std::string(8'000'000, '\0')));
  EXPECT_THAT(error_of([&] { load_map((folder / "bits.pbm.gz").string()); }), HasSubstr("more cells than a file"));
  write_file(folder / "bits.pbm", "P4\n8000 2200\n" + std::string(2'200'000, '\0'));
  EXPECT_EQ(std::get<GridMap>(load_map((folder / "bits.pbm").string()).map).cols, 8000);
}

TEST(MapText, RefusesDamagedAndOtherArchives) {
  const auto complaint = [](const std::string& bytes) { return error_of([&] { text_of(bytes); }); };
  const std::string packed = gzipped("a b\n");
  EXPECT_THAT(complaint(packed.substr(0, packed.size() - 9)), HasSubstr("damaged or not whole"));
  EXPECT_THAT(complaint(packed.substr(0, 12) + "x" + packed.substr(13)), HasSubstr("damaged or not whole"));
  EXPECT_THAT(complaint(packed + "rest"), HasSubstr("damaged or not whole"));
  EXPECT_THAT(complaint("PK\x03\x04rest"), HasSubstr("a ZIP archive"));
  EXPECT_THAT(complaint("BZh91AY"), HasSubstr("a file packed by bzip2"));
}

TEST(MapText, TakesUtf16) {
  const std::string text = "from,to\na,b\n";
  for (const bool big_end_first : {false, true}) {
    const std::string mark = big_end_first ? "\xFE\xFF" : "\xFF\xFE";
    EXPECT_EQ(text_of(mark + as_utf16(text, big_end_first)).text, text);
    EXPECT_EQ(text_of(as_utf16(text, big_end_first)).text, text);
  }
  EXPECT_EQ(text_of(std::string("\xFF\xFE\xE9\0\x3D\xD8\x00\xDE", 8)).text, "é😀");
  EXPECT_THAT(error_of([] { text_of("\xFF\xFE\x3D\xD8"); }), HasSubstr("not UTF-16"));
}

TEST(MapText, TakesLatin1WithANote) {
  const NotedText table = text_of("Caf\xE9,\x80\n");
  EXPECT_EQ(table.text, "Café,€\n");
  EXPECT_THAT(table.notes, ElementsAre(HasSubstr("not UTF-8, so read as Latin-1")));
  EXPECT_THAT(text_of("Café,€\n").notes, IsEmpty());
  const NotedText xml = text_of("<?xml version='1.0' encoding='ISO-8859-1'?><graphml x='\xE9'/>");
  EXPECT_THAT(xml.text, HasSubstr("x='é'"));
  EXPECT_THAT(xml.notes, IsEmpty());
}

TEST(MapText, EndsLinesAlike) {
  EXPECT_EQ(text_of("a\rb\r\nc\n\r\n\rd\r").text, "a\nb\nc\n\n\nd\n");
}

TEST(MapText, LeavesBytesAlone) {
  const std::string picture = "P5 2 1 255\n\r\xFF";
  EXPECT_EQ(text_of(picture).text, picture);
  EXPECT_EQ(text_of(gzipped(picture)).text, picture);
}

}  // namespace
}  // namespace graphdrl
