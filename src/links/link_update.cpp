#include "src/links/link_update.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <memory>
#include <optional>

#include "src/links/pair_update.h"
#include "src/links/root_shadows.h"

namespace exitance {
namespace {

/// Pairs of patches between which it is asked whether to stop.
constexpr std::size_t kTogether = 32;

class Update {
 public:
  Update(const LinkTask& task, LinkIndex& links, NodeRadiosity* differences)
      : task_(task), links_(links), differences_(differences), now_(*task.now, task.moved), left_(task.most_links) {
    if (task.before != nullptr) before_.emplace(*task.before, task.moved);
    const ChangedObjects* before = before_ ? &*before_ : nullptr;
    if (task.scope == LinkScope::hierarchical || task.scope == LinkScope::significant)
      shadows_.emplace(task, now_, before);
    const RootShadows* shadows = shadows_ ? &*shadows_ : nullptr;
    workers_ = Workers([this, before, shadows] { return std::make_unique<PairUpdate>(task_, now_, before, shadows); });
  }

  /// Everything, receiver by receiver. Returns what is left once the task is to stop.
  std::vector<PendingPair> run() {
    std::vector<std::vector<PendingPair>> left(links_.roots());
    std::atomic<bool> stopped = false;
    for_each_receiver([&](std::uint32_t r, PairUpdate& worker) {
      if (task_.scope != LinkScope::refinement && task_.stop && !stopped && task_.stop()) stopped = true;
      const bool leaves = stopped;
      std::vector<std::uint32_t> sources;
      find(r, worker, [&](std::uint32_t s, PairUpdate::Need need, std::span<const Link> links) {
        if (leaves && need != PairUpdate::Need::removal) {
          left[r].push_back({{r, s}, worker.stake({r, s}, links)});
        } else {
          sources.push_back(s);
        }
      });
      work(r, sources, worker);
    });
    return joined(left);
  }

  /// What there is to do, in order.
  std::vector<PendingPair> find_all() {
    std::vector<std::vector<PendingPair>> of_receiver(links_.roots());
    for_each_receiver([&](std::uint32_t r, PairUpdate& worker) {
      find(r, worker, [&](std::uint32_t s, PairUpdate::Need need, std::span<const Link> links) {
        const bool goes = need == PairUpdate::Need::removal;
        of_receiver[r].push_back(
            {{r, s}, goes ? std::numeric_limits<double>::infinity() : worker.stake({r, s}, links)});
      });
    });
    std::vector<PendingPair> all = joined(of_receiver);
    const auto goes = [](const PendingPair& p) { return p.stake == std::numeric_limits<double>::infinity(); };
    if (task_.order == LinkOrder::importance) {
      std::ranges::stable_sort(all, std::ranges::greater(), &PendingPair::stake);
    } else {
      std::stable_partition(all.begin(), all.end(), goes);
    }
    return all;
  }

  /// Works on pairs until the task is to stop; takes those that are done from the list.
  void run(std::vector<PendingPair>& pairs) {
    std::size_t done = static_cast<std::size_t>(
        std::ranges::find_if(pairs,
                             [](const PendingPair& p) { return p.stake != std::numeric_limits<double>::infinity(); }) -
        pairs.begin());
    work(std::span(pairs).first(done));
    while (done < pairs.size() && !(task_.stop && task_.stop())) {
      const std::size_t count = std::min(kTogether, pairs.size() - done);
      work(std::span(pairs).subspan(done, count));
      done += count;
    }
    pairs.erase(pairs.begin(), pairs.begin() + static_cast<std::ptrdiff_t>(done));
  }

  LinkWork done() const {
    LinkWork work;
    work.skipped = skipped_;
    for (const auto& worker : workers_) work += worker->work();
    return work;
  }

 private:
  static std::vector<PendingPair> joined(const std::vector<std::vector<PendingPair>>& of_receiver) {
    std::vector<PendingPair> all;
    for (const auto& pairs : of_receiver) all.insert(all.end(), pairs.begin(), pairs.end());
    return all;
  }

  using Workers = tbb::enumerable_thread_specific<std::unique_ptr<PairUpdate>>;

  template <class Do>
  void for_each_receiver(const Do& act) {
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(links_.roots()), 1),
                      [&](const auto& range) {
                        for (std::uint32_t r = range.begin(); r < range.end(); ++r) {
                          go_on(task_.abandon);
                          act(r, *workers_.local());
                        }
                      });
  }

  /// add(source, need, links) of all that needs work, ascending; marks what is to be skipped.
  template <class Add>
  void find(std::uint32_t r, const PairUpdate& worker, const Add& add) {
    std::vector<std::uint32_t> skipped;
    const auto look = [&](std::uint32_t s, std::span<const Link> links) {
      const PairUpdate::Need need = worker.need({r, s}, links);
      if (need == PairUpdate::Need::skip) {
        skipped.push_back(s);
      } else if (need != PairUpdate::Need::nothing) {
        add(s, need, links);
      }
    };
    std::uint32_t next = 0;  // of the sources
    const auto new_pairs = new_pairs_of(r);
    auto new_pair = new_pairs.begin();
    const auto look_at_new = [&](std::uint32_t below) {
      if (task_.new_pairs != nullptr) {
        for (; new_pair != new_pairs.end() && new_pair->source < below; ++new_pair) look(new_pair->source, {});
      } else if (adds_pairs_) {
        for (; next < below; ++next) look(next, {});
      }
    };
    if (task_.sources != nullptr) {
      for (const std::uint32_t s : *task_.sources) look(s, std::as_const(links_).between(r, s));
    } else {
      links_.for_each_source(r, [&](std::uint32_t s, std::span<const Link> links) {
        look_at_new(s);
        look(s, links);
        next = s + 1;
      });
      look_at_new(static_cast<std::uint32_t>(task_.tree->roots().size()));
    }
    for (const std::uint32_t s : skipped) links_.mark_stale(r, s);
    skipped_ += skipped.size();
  }

  std::span<const PatchPair> new_pairs_of(std::uint32_t r) const {
    if (task_.new_pairs == nullptr) return {};
    return {std::ranges::lower_bound(*task_.new_pairs, r, {}, &PatchPair::receiver),
            std::ranges::upper_bound(*task_.new_pairs, r, {}, &PatchPair::receiver)};
  }

  void work(std::uint32_t r, std::span<const std::uint32_t> sources, PairUpdate& worker) {
    std::vector<LinkIndex::Replacement> replacements;
    std::vector<Link> made;
    std::uint64_t added = 0;
    for (const std::uint32_t s : sources) {
      const std::span<const Link> old = std::as_const(links_).between(r, s);
      if (!worker.update({r, s}, old, made)) continue;
      if (made.size() > old.size()) added += made.size() - old.size();
      if (added > left_) refuse_more_links(task_);
      replacements.push_back({s, std::move(made)});
    }
    if (replacements.empty()) return;
    std::uint64_t left = left_;
    do {
      if (added > left) refuse_more_links(task_);
    } while (!left_.compare_exchange_weak(left, left - added));
    if (differences_ != nullptr) {
      for (const LinkIndex::Replacement& r_s : replacements) {
        receive_difference(std::as_const(links_).between(r, r_s.source), r_s.links);
      }
    }
    links_.replace(r, replacements);
  }

  /// What links between two patches bring more than those before.
  void receive_difference(std::span<const Link> before, std::span<const Link> now) {
    const auto receive = [&](const Link& link, double more) {
      if (more != 0) differences_->receive(link.destination, more, link.source);
    };
    const auto brings = [](const Link& link) { return link.ghost ? 0 : link.transfer(); };
    std::size_t k = 0, n = 0;
    while (k < before.size() || n < now.size()) {
      if (n == now.size() || (k < before.size() && before[k].code < now[n].code)) {
        receive(before[k], -brings(before[k]));
        ++k;
      } else if (k == before.size() || now[n].code < before[k].code) {
        receive(now[n], brings(now[n]));
        ++n;
      } else {
        receive(now[n], brings(now[n]) - brings(before[k]));
        ++k, ++n;
      }
    }
  }

  void work(std::span<const PendingPair> pairs) {
    std::vector<PatchPair> sorted;
    for (const PendingPair& p : pairs) sorted.push_back(p.pair);
    std::ranges::sort(sorted);
    std::vector<std::uint32_t> sources;
    std::vector<std::size_t> first;  // of each receiver
    for (std::size_t k = 0; k < sorted.size(); ++k) {
      if (k == 0 || sorted[k].receiver != sorted[k - 1].receiver) first.push_back(k);
      sources.push_back(sorted[k].source);
    }
    first.push_back(sorted.size());
    tbb::parallel_for(std::size_t{0}, first.size() - 1, [&](std::size_t k) {
      go_on(task_.abandon);
      work(sorted[first[k]].receiver, std::span(sources).subspan(first[k], first[k + 1] - first[k]), *workers_.local());
    });
  }

  const LinkTask& task_;
  LinkIndex& links_;
  NodeRadiosity* differences_;
  ChangedObjects now_;
  std::optional<ChangedObjects> before_;
  std::optional<RootShadows> shadows_;
  /// Whether pairs without links may get some.
  bool adds_pairs_ = task_.scope == LinkScope::refinement || std::ranges::find(task_.moved, 1) != task_.moved.end();
  std::atomic<std::uint64_t> left_, skipped_ = 0;
  Workers workers_;
};

}  // namespace

LinkWork update_links(const LinkTask& task, LinkIndex& links, NodeRadiosity* differences,
                      std::vector<PendingPair>* pending) {
  links.grow(task.tree->roots().size());
  Update update(task, links, differences);
  if (pending == nullptr) {
    update.run();
  } else if (pending->empty() && task.order == LinkOrder::any) {
    *pending = update.run();
  } else {
    if (pending->empty()) *pending = update.find_all();
    update.run(*pending);
  }
  return update.done();
}

}  // namespace exitance
