#include <iostream>
#include "io/inspect.h"
int main(int, char** argv) {
  const auto scan = isthmus::io::inspect_scan({argv[1]});
  std::cout << (scan ? scan->header.format + ": " + std::to_string(scan->num_read) + " points\n" : scan.error().text());
}
