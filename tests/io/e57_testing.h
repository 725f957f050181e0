// E57 files by hand, byte by byte, by the words of the standard and with a checksum of their own: the twin of
// src/io/e57.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io_testing.h"

namespace isthmus::io::testing {

/// CRC-32C bit by bit.
inline std::uint32_t slow_crc32c(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFF;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) != 0 ? (crc >> 1) ^ 0x82F63B78 : crc >> 1;
  }
  return crc ^ 0xFFFFFFFF;
}

/// Data bytes as pages with right checksums.
inline std::string paged(std::string logical) {
  std::string file;
  logical.resize((logical.size() + 1019) / 1020 * 1020, '\0');
  for (std::size_t place = 0; place < logical.size(); place += 1020) {
    const std::string page = logical.substr(place, 1020);
    file += page + bytes_of_value(slow_crc32c(page), true);
  }
  return file;
}

/// The data bytes of whole pages.
inline std::string unpaged(const std::string& file) {
  std::string logical;
  for (std::size_t place = 0; place < file.size(); place += 1024) logical += file.substr(place, 1020);
  return logical;
}

inline std::uint64_t physical(std::uint64_t logical) { return logical / 1020 * 1024 + logical % 1020; }

/// Values of `bits` bits each, the lowest bit first.
inline std::string packed(const std::vector<std::uint64_t>& values, unsigned bits) {
  std::string bytes((values.size() * bits + 7) / 8, '\0');
  std::size_t at = 0;
  for (const std::uint64_t value : values) {
    for (unsigned bit = 0; bit < bits; ++bit, ++at) {
      if ((value >> bit & 1) != 0) bytes[at / 8] = static_cast<char>(bytes[at / 8] | 1 << at % 8);
    }
  }
  return bytes;
}

template <class T>
std::string raw_bytes(const std::vector<T>& values) {
  std::string bytes;
  for (const T value : values) bytes += bytes_of_value(value);
  return bytes;
}

inline std::string data_packet(const std::vector<std::string>& pieces) {
  std::string lengths, bytes;
  for (const std::string& piece : pieces) {
    lengths += bytes_of_value(static_cast<std::uint16_t>(piece.size()));
    bytes += piece;
  }
  std::string rest = bytes_of_value(static_cast<std::uint16_t>(pieces.size())) + lengths + bytes;
  while (rest.size() % 4 != 0) rest += '\0';
  return std::string("\1\0", 2) + bytes_of_value(static_cast<std::uint16_t>(rest.size() + 3)) + rest;
}

/// An index packet (type 0) or an empty one (type 2) of so many bytes.
inline std::string other_packet(char type, std::size_t bytes) {
  std::string packet = std::string{type, '\0'} + bytes_of_value(static_cast<std::uint16_t>(bytes - 1));
  packet.resize(bytes, '\0');
  return packet;
}

/// <name type="..." .../>
inline std::string field_xml(const std::string& name, const std::string& attributes) {
  return "<" + name + " " + attributes + "/>";
}
inline std::string doubles_xml(const std::vector<std::string>& names) {
  std::string xml;
  for (const std::string& name : names) xml += field_xml(name, R"(type="Float")");
  return xml;
}
const std::vector<std::string> kXyz = {"cartesianX", "cartesianY", "cartesianZ"};

struct HandMadeE57 {
  std::string logical = std::string(48, '\0');
  std::string scans_xml, more_xml;

  /// Appends a section with these packets and a scan that refers to it.
  void add_scan(std::uint64_t records, const std::string& prototype, const std::string& packets,
                const std::string& scan_xml = {}) {
    while (logical.size() % 4 != 0) logical += '\0';
    const std::size_t begin = logical.size();
    logical += std::string("\1\0\0\0\0\0\0\0", 8) + bytes_of_value(std::uint64_t{32 + packets.size()}) +
               bytes_of_value(physical(begin + 32)) + bytes_of_value(std::uint64_t{0}) + packets;
    add_xml(physical(begin), records, prototype, scan_xml);
  }
  void add_xml(std::uint64_t offset, std::uint64_t records, const std::string& prototype,
               const std::string& scan_xml = {}) {
    scans_xml += "<vectorChild type=\"Structure\">" + scan_xml + "<points type=\"CompressedVector\" fileOffset=\"" +
                 std::to_string(offset) + "\" recordCount=\"" + std::to_string(records) +
                 "\"><prototype type=\"Structure\">" + prototype + "</prototype></points></vectorChild>\n";
  }
  [[nodiscard]] std::string xml() const {
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<e57Root type=\"Structure\"><guid "
           "type=\"String\"><![CDATA[{f}]]></guid><data3D type=\"Vector\">" +
           scans_xml + "</data3D>" + more_xml + "</e57Root>\n";
  }
  /// With `xml_at` (logical) the XML is put there, where room for it must have been left.
  [[nodiscard]] std::string file(std::uint64_t xml_at = 0) const {
    std::string all = logical;
    const std::string text = xml();
    if (xml_at == 0) {
      xml_at = all.size();
      all += text;
    } else {
      all.replace(xml_at, text.size(), text);
    }
    const std::uint64_t size = (all.size() + 1019) / 1020 * 1024;
    all.replace(0, 48,
                "ASTM-E57" + bytes_of_value(std::uint32_t{1}) + bytes_of_value(std::uint32_t{0}) +
                    bytes_of_value(size) + bytes_of_value(physical(xml_at)) +
                    bytes_of_value(std::uint64_t{text.size()}) + bytes_of_value(std::uint64_t{1024}));
    return paged(all);
  }
};

}  // namespace isthmus::io::testing
