#include <iostream>
#include "pipelines/survey_pipeline.h"
int main() {  // two scans without a point: nothing to find, and no crash
  isthmus::ScanProduct a, b;
  a.sampled.voxel_m = b.sampled.voxel_m = 0.1;
  std::cout << isthmus::to_string(isthmus::register_pair(a, b, {}).verdict) << '\n';
}
