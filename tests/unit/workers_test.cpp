// Processes that answer at once hand their answers on in the order of the questions, and one that ends is named.
#include <chrono>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <omp.h>
#include <unistd.h>

#include "harness/failure.h"
#include "harness/workers.h"
#include "variants/cpu/parallel_for.h"

namespace pt {
namespace {

std::vector<std::string> questions_up_to(int count) {
    std::vector<std::string> questions;
    for (int i = 0; i < count; ++i) {
        questions.push_back(std::to_string(i));
    }
    return questions;
}

TEST(Workers, AnswersComeInTheOrderOfTheQuestions) {
    Workers workers(3, [](const std::string& question) {
        // Every third is slow, so that those after it are there first.
        if (std::stoi(question) % 3 == 0) {
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        return question + " " + std::string(100000, 'x');
    });
    std::vector<std::size_t> order;
    workers.ask(questions_up_to(40), [&](std::size_t question, const std::string& answer) {
        order.push_back(question);
        EXPECT_EQ(answer, fmt::format("{} {}", question, std::string(100000, 'x')));
    });
    ASSERT_EQ(order.size(), 40u);
    EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
}

TEST(Workers, MoreWorkersThanQuestionsAndNoQuestions) {
    Workers workers(4, [](const std::string& question) { return question; });
    workers.ask({}, [](std::size_t, const std::string&) { FAIL(); });
    int answers = 0;
    workers.ask(questions_up_to(2), [&](std::size_t, const std::string&) { ++answers; });
    EXPECT_EQ(answers, 2);
    workers.ask(questions_up_to(9), [&](std::size_t, const std::string&) { ++answers; });
    EXPECT_EQ(answers, 11);
}

TEST(Workers, PrepareOnceEach) {
    static int prepared = 0;  // each process has its own
    Workers workers(
        2, [](const std::string&) { return std::to_string(prepared); },
        [] {
            prepared += 1;
            throw InputError("a thing that the first question will meet again");
        });
    workers.ask(questions_up_to(5), [](std::size_t, const std::string& answer) { EXPECT_EQ(answer, "1"); });
    EXPECT_EQ(prepared, 0);
}

TEST(Workers, ShareTheThreads) {
    const int before = omp_get_max_threads();
    omp_set_num_threads(7);
    Workers workers(3, [](const std::string&) { return std::to_string(parallel_threads()); });
    workers.ask(questions_up_to(5), [](std::size_t, const std::string& answer) { EXPECT_EQ(answer, "2"); });
    Workers many(9, [](const std::string&) { return std::to_string(parallel_threads()); });
    many.ask(questions_up_to(9), [](std::size_t, const std::string& answer) { EXPECT_EQ(answer, "1"); });
    EXPECT_EQ(parallel_threads(), 7);
    omp_set_num_threads(before);
}

TEST(Workers, OneThatEndsIsNamedWithItsQuestion) {
    Workers workers(2, [](const std::string& question) {
        if (question == "5") {
            ::_exit(7);
        }
        return question;
    });
    try {
        workers.ask(questions_up_to(20), [](std::size_t question, const std::string&) { EXPECT_LT(question, 5u); });
        FAIL() << "nothing was thrown";
    } catch (const MachineError& error) {
        EXPECT_STREQ(error.what(), "a worker ended with exit code 7 at 5");
    }
}

}  // namespace
}  // namespace pt
