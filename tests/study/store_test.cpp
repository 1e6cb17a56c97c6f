#include "study/store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "failure/failure.h"
#include "tests/recording/scratch.h"

namespace abbe::study {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

const Row kQuestion{{"abbe_study", "toy"}, {"variant", ""}};

class StoreTest : public testing::Test {
 protected:
  fs::path path() const { return scratch_ / "rows.jsonl"; }
  std::string Text() const {
    std::ostringstream text;
    text << std::ifstream(path()).rdbuf();
    return text.str();
  }
  void Write(const std::string& text) const { std::ofstream(path()) << text; }

  const recording::Scratch scratch_;
};

TEST_F(StoreTest, IsInTheOrderOfTheSeedsWhenItIsFinished) {
  {
    Store store = Store::Open(path(), kQuestion, Store::kNew);
    store.Add(3, {{"x", 0.1}});
    store.Add(1, {{"x", 2}});
    EXPECT_EQ(
        Text(),
        "{\"abbe_study\":\"toy\",\"variant\":\"\"}\n{\"seed\":3,\"x\":0.1}\n{\"seed\":1,\"x\":2}\n");
    store.Finish();
  }
  EXPECT_EQ(
      Text(),
      "{\"abbe_study\":\"toy\",\"variant\":\"\"}\n{\"seed\":1,\"x\":2}\n{\"seed\":3,\"x\":0.1}\n");
}

TEST_F(StoreTest, GoesOnBehindItsLastWholeLine) {
  {
    Store store = Store::Open(path(), kQuestion, Store::kNew);
    store.Add(1, {{"x", 1}});
  }
  Write(Text() + "{\"seed\":2,\"x\"");
  {
    Store store = Store::Open(path(), kQuestion, Store::kGoOn);
    EXPECT_EQ(store.rows().size(), 1);
    store.Add(3, {{"x", 9}});
  }
  const Stored stored = ReadStores({path()});
  ASSERT_EQ(stored.rows.size(), 2);
  EXPECT_EQ(stored.rows.at(3).at("x"), 9);
}

TEST_F(StoreTest, RefusesWhatIsThereAndWhatIsAnotherQuestion) {
  { Store store = Store::Open(path(), kQuestion, Store::kNew); }
  EXPECT_THAT([&] { Store::Open(path(), kQuestion, Store::kNew); },
              ThrowsMessage<InputError>(HasSubstr("--resume")));
  EXPECT_THAT(
      [&] {
        Store::Open(path(), {{"abbe_study", "other"}}, Store::kGoOn);
      },
      ThrowsMessage<InputError>(HasSubstr("another name")));
}

TEST_F(StoreTest, IsOfOneWriter) {
  Store store = Store::Open(path(), kQuestion, Store::kNew);
  EXPECT_THAT([&] { Store::Open(path(), kQuestion, Store::kGoOn); },
              ThrowsMessage<InputError>(HasSubstr("another abbe study writes it")));
}

TEST_F(StoreTest, NamesTheLineThatIsNoRow) {
  for (const char* line : {"seed 3", "{}", "[1]", "{\"seed\":-1}", "{\"seed\":\"1\"}", "\xff"}) {
    Write(kQuestion.dump() + "\n{\"seed\":1}\n" + line + "\n");
    EXPECT_THAT([&] { ReadStores({path()}); },
                ThrowsMessage<InputError>(HasSubstr("rows.jsonl:3:")))
        << line;
  }
  Write("");
  EXPECT_THAT([&] { ReadStores({path()}); }, ThrowsMessage<InputError>(HasSubstr("first line")));
}

TEST_F(StoreTest, MergesShardsAndRefusesTwoResultsOfOneSeed) {
  const fs::path other = scratch_ / "other.jsonl";
  Write(kQuestion.dump() + "\n{\"seed\":1,\"x\":1}\n{\"seed\":2,\"failed\":\"why\"}\n");
  std::ofstream(other) << kQuestion.dump() + "\n{\"seed\":1,\"x\":1}\n{\"seed\":5,\"x\":5}\n";
  const Stored both = ReadStores({path(), other});
  EXPECT_EQ(both.rows.size(), 3);
  EXPECT_EQ(both.Good().size(), 2);
  std::ofstream(other) << kQuestion.dump() + "\n{\"seed\":1,\"x\":7}\n";
  EXPECT_THAT(
      [&] {
        ReadStores({path(), other});
      },
      ThrowsMessage<InputError>(HasSubstr("seed 1 was worked out with another result")));
}

}  // namespace
}  // namespace abbe::study
