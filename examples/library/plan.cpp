// Plans a walk on a map of any format, in C++17, and draws it:
//
//   plan_in_cpp MAP [PICTURE]
#include <graphdrl/graphdrl.h>

#include <iostream>

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    std::cerr << "plan_in_cpp: expected MAP [PICTURE]\n";
    return 2;
  }
  try {
    const auto world = graphdrl::World::from_file(argv[1]);
    int best = 0;
    const auto task = graphdrl::Task::relative(0.9).back_to_start().progress([&best](int visited, double) {
      if (visited > best) std::cerr << "so far " << (best = visited) << " nodes\n";
      return true;
    });
    const graphdrl::Plan plan = graphdrl::plan(world, task);
    std::cout << world.name() << ": " << plan.visited() << " of " << world.valid_count() << " nodes in "
              << plan.walk().size() - 1 << " steps; no walk visits more than " << plan.bound() << "\n";
    if (argc == 3) plan.save(argv[2]);
  } catch (const graphdrl::Error& error) {
    std::cerr << "plan_in_cpp: " << error.what() << "\n";
    return error.bad_input() ? 2 : 1;
  }
}
