// What the online explorer's network sees of an unknown map: one row of numbers per possible first visit, and one of
// all that was seen so far, by which it may tell a grid from a tree. Nothing depends on numbers, places or size.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "graphdrl/env/exploration.h"
#include "graphdrl/graph/search.h"

namespace graphdrl {

// Costs are in mean edges, sizes and counts as logarithms.
inline constexpr auto kOnlineVisitFeatures = std::to_array<std::string_view>({
    "further",           // than the nearest
    "times_further",     // likewise, as a ratio
    "nearest",           // or as near
    "met",               // visited neighbours
    "met_rank",          // from the fewest of all first visits, 0, to the most, 1
    "met_share",         // of the mean degree seen so far
    "likely_new",        // mean degree less visited neighbours
    "seen_rank",         // 1 of the one seen last, 1/2 of the next …
    "first_seen_rank",   // likewise of the one first seen last
    "since_seen",        // visits
    "since_first_seen",  // visits
    "just_found",        // first seen by the last visit
    "near_2",            // frontier nodes within two known steps
    "near_4",            // within four
    "to_next",           // steps to the nearest other one
    "part",              // frontier nodes of its part
    "part_share",        // of the frontier
    "least_degree",      // of visited neighbours
    "most_siblings",     // frontier nodes next to a visited neighbour, the most
    "dense",             // visited nodes within two known steps
    "budget_share",      // of what is free to spend, the cost
    "depth",             // visits between those that first showed it and the current node
});

inline constexpr auto kOnlineMapFeatures = std::to_array<std::string_view>({
    "budget_left",        // the share; 1 without a limit
    "degree",             // mean
    "degree_spread",      // standard deviation over mean
    "clustering",         // pairs of visited neighbours that are joined
    "dead_ends",          // share of visits that showed nothing new
    "cycles",             // visited neighbours beyond one, over the mean degree
    "frontier",           // nodes for each visited one
    "efficiency",         // nodes visited for each mean edge walked
    "visited",            // nodes
    "low_degree",         // share of nodes with at most two edges
    "budget_left_edges",  // mean edges
    "meetings",           // share of visits with two visited neighbours
    "oldest",             // how long the nearest part of the frontier has waited, in visits made
    "unlimited",          // no budget
    "home",               // an end must be reached
});

inline constexpr int kOnlineVisitFeatureCount = static_cast<int>(kOnlineVisitFeatures.size());
inline constexpr int kOnlineMapFeatureCount = static_cast<int>(kOnlineMapFeatures.size());
inline constexpr int kOnlineFeatureCount = kOnlineVisitFeatureCount + kOnlineMapFeatureCount;

// How many first visits are looked at, nearest first. The first is the one that pocket would take; the second, where it
// is about as near, the one that open would.
inline constexpr int kOnlineVisits = 16;
inline constexpr double kAboutAsNear = 1 + 1e-9;

// Scratch memory. One thread at a time.
struct OnlineScratch {
  std::vector<FirstVisit> visits;
  std::vector<std::uint32_t> marks;  // [N]
  std::uint32_t mark = 0;
  std::vector<NodeId> queue;
  std::vector<int> steps;
};

// Appends a row for each first visit that is looked at, both kinds of features end to end; gives these first visits,
// until the scratch memory is used again. budget: of the whole walk. search: meets the ways there. REQUIRES: the view
// grows. Cost: what is nearer, and a part of what is near each.
std::span<const FirstVisit> encode_online(const Exploration& now, double budget, double spent, OnlineScratch& scratch,
                                          NearestFirst& search, std::vector<float>& rows);

}  // namespace graphdrl
