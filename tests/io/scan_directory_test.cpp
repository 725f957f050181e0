#include "io/scan_directory.h"

#include <algorithm>
#include <cstdlib>

#include "io_testing.h"
#include "shared_data.h"

namespace isthmus::io::testing {
namespace {

namespace fs = std::filesystem;

class Directory : public IoTest {
 protected:
  std::vector<std::string> names(const ScanListing& listing) const {
    std::vector<std::string> all;
    for (const auto& listed : listing.scans) all.push_back(listed.scan.name + (listed.error ? " !" : ""));
    return all;
  }
};

using Strings = std::vector<std::string>;

const std::string kPtx = "1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 0.5\n";

TEST_F(Directory, TakesScansByTheRulesInAFixedOrder) {
  for (const char* name : {"b.xyz", "a scan.xyz", "sub/c.xyz", "d.XYZ", "s10.xyz", "s2.txt", "odd#1%.xyz"})
    write(name, "1 2 3\n");
  write("b.ply", "not read when listing");
  write("poses.txt", "a 1 0 0 0\n");
  for (const char* name : {"poses_refined.txt", "overlaps.gt.txt", "x.gt.txt", "Overlaps1.txt"}) write(name, "1 2 3\n");
  for (const char* name :
       {"a.pose", "a.frames", "bun.conf", "resolved.yaml", "report.html", ".hidden.xyz", ".git/x.xyz"})
    write(name, "1 2 3\n");
  write("scans.csv", "id,name,points\n0,a,3\n");
  write("readme.txt", "Seven stations.\n");
  write("points.csv", "x,y,z\n1,2,3\n");
  write("lone.fls", "FARO");
  write("b.laz", "LASF");
  write("two.ptx", kPtx + kPtx);
  const auto listing = list_scans({folder});
  ASSERT_TRUE(listing) << error_of(listing);
  EXPECT_EQ(names(*listing), (Strings{"a%20scan.xyz", "b.ply", "d.XYZ", "lone.fls !", "odd%231%25.xyz", "points.csv",
                                      "s10.xyz", "s2.txt", "sub/c.xyz", "two.ptx#0", "two.ptx#1"}));
  EXPECT_NE(listing->scans[3].error->text().find("unsupported format"), std::string::npos);
  const auto noted = [&](const std::string& text) {
    return std::find(listing->notes.begin(), listing->notes.end(), text) != listing->notes.end();
  };
  EXPECT_EQ(listing->warnings, (Strings{"b.laz: not used, b.ply is taken for the same scan",
                                        "b.xyz: not used, b.ply is taken for the same scan"}));
  EXPECT_TRUE(noted("scans.csv: no coordinates, not taken as a scan"));
  EXPECT_TRUE(noted("readme.txt: no coordinates, not taken as a scan"));
  EXPECT_TRUE(noted("1 files with extension '.yaml' are no scans"));
}

TEST_F(Directory, NamedFilesAreTakenAsNamedWhateverTheirOrder) {
  const auto a = write("one/a.xyz", "1 2 3\n"), b = write("two/deep/b.xyz", "1 2 3\n"), c = write("two/a.ply", "");
  const auto listing = list_scans({b, a, folder / "two" / "missing.pcd", c, a});
  ASSERT_TRUE(listing) << error_of(listing);
  EXPECT_EQ(names(*listing), (Strings{"one/a.xyz", "two/a.ply !", "two/deep/b.xyz", "two/missing.pcd !"}));
  const auto other = list_scans({a, a, c, folder / "two" / "missing.pcd", b});
  EXPECT_EQ(names(*listing), names(*other));
  EXPECT_EQ(names(*list_scans({a})), Strings{"a.xyz"});
  EXPECT_EQ(names(*list_scans({folder / "one" / "", folder / "two"})),
            (Strings{"one/a.xyz", "two/a.ply !", "two/deep/b.xyz"}));
}

TEST_F(Directory, SkipsTheOutputFolderAndNotesLinkedFolders) {
  write("a.xyz", "1 2 3\n");
  write("out/store/b.xyz", "1 2 3\n");
  fs::create_directory_symlink(folder / "out", folder / "link");
  const auto listing = list_scans({folder}, {folder / "out"});
  ASSERT_TRUE(listing) << error_of(listing);
  EXPECT_EQ(names(*listing), Strings{"a.xyz"});
  EXPECT_EQ(listing->warnings, Strings{"link: a link to a folder, not entered"});
}

/// Unreadable: whatever holds "broken".
std::optional<Error> trouble_of(const ScanRef& scan) {
  std::ifstream file(scan.path);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (text.find("broken") == std::string::npos) return std::nullopt;
  return Error{"it is broken", scan.path.string(), {}};
}

TEST_F(Directory, ABrokenFileGivesWayToItsTwin) {
  write("a.ply", "broken");
  write("a.xyz", "1 2 3\n");
  write("b.ply", "good enough");
  write("b.xyz", "1 2 3\n");
  write("c.ply", "broken");
  write("c.pts", "broken");
  write("c.xyz", "1 2 3\n");
  write("d.ply", "broken");
  write("d.xyz", "broken");
  write("e.ply", "broken");
  auto listing = list_scans({folder});
  ASSERT_TRUE(listing) << error_of(listing);
  EXPECT_EQ(names(*listing), (Strings{"a.ply", "b.ply", "c.ply", "d.ply", "e.ply"}));
  take_readable_twins(*listing, trouble_of);
  EXPECT_EQ(names(*listing), (Strings{"a.xyz", "b.ply", "c.xyz", "d.ply", "e.ply"}));
  EXPECT_EQ(listing->warnings, (Strings{"a.ply: cannot be used (it is broken), a.xyz is taken for the same scan",
                                        "b.xyz: not used, b.ply is taken for the same scan",
                                        "c.ply: cannot be used (it is broken), c.xyz is taken for the same scan",
                                        "c.pts: not used, c.ply is taken for the same scan",
                                        "d.xyz: not used, d.ply is taken for the same scan"}));
}

TEST_F(Directory, ATwinThatIsNamedAsWellIsListedOnce) {
  write("a.ply", "broken");
  const auto named = write("a.xyz", "1 2 3\n");
  auto listing = list_scans({folder, named});
  ASSERT_TRUE(listing) << error_of(listing);
  take_readable_twins(*listing, trouble_of);
  EXPECT_EQ(names(*listing), Strings{"a.xyz"});
}

TEST_F(Directory, MissingInputsFail) {
  EXPECT_NE(error_of(list_scans({})).find("no scans given"), std::string::npos);
  EXPECT_NE(error_of(list_scans({folder / "nowhere"})).find("no such file or folder"), std::string::npos);
  EXPECT_TRUE(list_scans({folder})->scans.empty());
}

TEST_F(Directory, ResolvesNamesOfFilesAndOfScansInThem) {
  const std::string two = write("my file.ptx", kPtx + kPtx).string();
  EXPECT_EQ(resolve_scan_name(two + "#1")->index, 1);
  EXPECT_EQ(resolve_scan_name(two + "#1")->name, "my%20file.ptx#1");
  EXPECT_EQ(resolve_scan_name((folder / "my%20file.ptx#0").string())->index, 0);
  EXPECT_NE(error_of(resolve_scan_name(two)).find("holds 2 scans"), std::string::npos);
  EXPECT_NE(error_of(resolve_scan_name(two + "#2")).find("there is no #2"), std::string::npos);
  EXPECT_NE(error_of(resolve_scan_name(two + "#x")).find("no such file"), std::string::npos);
  EXPECT_NE(error_of(resolve_scan_name(folder.string())).find("is a folder"), std::string::npos);
  const auto odd = write("a#1.xyz", "1 2 3\n");
  EXPECT_EQ(resolve_scan_name(odd.string())->path, odd);
  EXPECT_TRUE(read_whole(*resolve_scan_name(two + "#1")));
}

TEST(SharedDirectories, EverySetListsItsScansAndNothingElse) {
  ISTHMUS_SHARED_DATA_OR_SKIP(data);
  const std::pair<const char*, std::size_t> sets[] = {
      {"tls_eth_facade", 7},    {"tls_3dtk_dat", 3},    {"nclt_a", 16},          {"kitti_00_a", 5},
      {"newer_college_01", 5},  {"stanford_bunny", 10}, {"stanford_dragon", 15}, {"fragments_redkitchen", 3},
      {"rgbd_bunny_views", 12}, {"object_hippo", 2}};
  for (const auto& [name, count] : sets) {
    const auto listing = list_scans({data / name});
    ASSERT_TRUE(listing) << error_of(listing);
    EXPECT_EQ(listing->scans.size(), count) << name;
    for (const auto& listed : listing->scans) EXPECT_FALSE(listed.error.has_value()) << listed.scan.name;
  }
  EXPECT_EQ(list_scans({data / "tls_3dtk_dat"})->scans[0].scan.name, "scan000.xyz");
}

}  // namespace
}  // namespace isthmus::io::testing
