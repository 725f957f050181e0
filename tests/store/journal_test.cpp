#include "store/journal.h"

#include <gtest/gtest.h>

#include <fstream>
#include <thread>

#include "base/temporary_folder.h"
#include "store/store.h"

namespace isthmus::store {
namespace {

TEST(Journal, says_what_was_written_in_order) {
  const testing::TemporaryFolder folder;
  {
    const auto journal = Journal::open(folder / "journal");
    ASSERT_TRUE(journal) << journal.error().text();
    (*journal)->write({0, "run", "", "", "register", 0});
    (*journal)->write({0, "made", "pair", "00ff", "a with\ta\nb", 1.5});
  }
  const std::vector<ProcessJournal> journals = read_journals(folder / "journal");
  ASSERT_EQ(journals.size(), 1U);
  ASSERT_EQ(journals[0].lines.size(), 2U);
  EXPECT_EQ(journals[0].lines[0].item, "register");
  EXPECT_EQ(journals[0].lines[1].item, "a with a b");
  EXPECT_EQ(journals[0].lines[1].stage, "pair");
  EXPECT_EQ(journals[0].lines[1].digest, "00ff");
  EXPECT_EQ(journals[0].lines[1].seconds, 1.5);
  EXPECT_GT(journals[0].lines[1].time, 1.7e9);
  EXPECT_EQ(journals[0].count("made"), 1U);
}

TEST(Journal, every_opening_has_a_file_of_its_own) {
  const testing::TemporaryFolder folder;
  ASSERT_TRUE(Journal::open(folder.path()));
  ASSERT_TRUE(Journal::open(folder.path()));
  EXPECT_EQ(read_journals(folder.path()).size(), 2U);
}

TEST(Journal, that_was_cut_or_is_nonsense_is_read_as_far_as_it_makes_sense) {
  const testing::TemporaryFolder folder;
  std::ofstream(folder / "a.tsv") << "1.5\tmade\tpair\t00\tx\t2\nnonsense\n1\t2\t3\t4\t5\tsix\n\n2\tmade\tpair\t01\tcu";
  std::ofstream(folder / "b.tsv") << "";
  std::ofstream(folder / "not a journal") << "1\tmade\tpair\t00\tx\t2\n";
  const std::vector<ProcessJournal> journals = read_journals(folder.path());
  ASSERT_EQ(journals.size(), 2U);
  ASSERT_EQ(journals[0].lines.size(), 1U);
  EXPECT_EQ(journals[0].lines[0].digest, "00");
  EXPECT_TRUE(journals[1].lines.empty());
  EXPECT_TRUE(read_journals(folder / "missing").empty());
}

TEST(Journal, lines_of_many_threads_do_not_mix) {
  const testing::TemporaryFolder folder;
  const auto journal = Journal::open(folder.path());
  ASSERT_TRUE(journal);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < 200; ++i)
        (*journal)->write({0, "made", "pair", "", std::string(100, static_cast<char>('a' + t)), 0});
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(read_journals(folder.path()).at(0).count("made"), 800U);
}

TEST(Journal, of_a_store_has_the_beginning_and_the_end_of_every_work) {
  const testing::TemporaryFolder folder;
  auto store = Store::open(folder / "store", {});
  ASSERT_TRUE(store);
  const auto journal = Journal::open(folder / "journal");
  ASSERT_TRUE(journal);
  store->set_journal(*journal);
  store->work({"pair", "0a"}, "b with a").made();
  store->work({"sampled", "0b"}, "c").failed({"too few points", "c", ""});
  const std::vector<JournalLine> lines = read_journals(folder / "journal").at(0).lines;
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[0].event + lines[0].stage + lines[0].item, "beganpairb with a");
  EXPECT_EQ(lines[1].event, "made");
  EXPECT_EQ(lines[3].event + " " + lines[3].item, "failed c: too few points");
  ASSERT_TRUE(store->save({"pair", "0a0a"}, 5));
  EXPECT_FALSE(store->load<int>({"pair", "0b0b"}));
  EXPECT_EQ(store->load<int>({"pair", "0a0a"}), 5);
  EXPECT_EQ(store->load<int>({"pair", "0a0a"}), 5);
  const ProcessJournal journal_of_store = read_journals(folder / "journal").at(0);
  EXPECT_EQ(journal_of_store.count("kept"), 1U);
  EXPECT_EQ(journal_of_store.count("found"), 1U);
  Store::none().work({"pair", "0a"}, "b with a").made();  // a store without a journal says nothing
}

}  // namespace
}  // namespace isthmus::store
