/* A round trip for a delivery robot, in C: seven doors, the minutes between them, 12 minutes in all.
 *
 *   cc plan.c $(pkg-config --cflags --libs graphdrl) -o plan && ./plan
 */
#include <graphdrl/graphdrl_c.h>
#include <stdio.h>

static const char* const kDoors[] = {"dock", "lobby", "office", "kitchen", "lab", "store", "roof"};

/* Edges lead both ways. */
static const int32_t kEdges[] = {0, 1, 1, 2, 2, 3, 3, 1, 1, 4, 4, 5, 5, 0, 4, 6};
static const double kMinutes[] = {1, 2, 1.5, 2, 2.5, 1, 3, 6};

static int failed(void) {
  fprintf(stderr, "plan: %s\n", graphdrl_last_error());
  return 1;
}

static int print_walk(const graphdrl_result* result) {
  size_t length = 0;
  const int32_t* walk = graphdrl_result_walk(result, &length);
  for (size_t i = 0; i < length; ++i) printf("%s%s", i > 0 ? " - " : "", kDoors[walk[i]]);
  printf("\n%d doors in %g of %g minutes; no walk reaches more than %g%s\n", (int)graphdrl_result_visited(result),
         graphdrl_result_cost(result), graphdrl_result_budget(result), graphdrl_result_bound(result),
         graphdrl_result_optimal(result) ? ": this one is the best" : "");
  return 0;
}

int main(void) {
  graphdrl_world* world = NULL;
  if (graphdrl_world_from_edges("house", 7, sizeof kMinutes / sizeof *kMinutes, kEdges, kMinutes, 0, NULL, NULL,
                                &world) != GRAPHDRL_DONE) {
    return failed();
  }
  graphdrl_task task;
  graphdrl_task_init(&task);
  task.budget = 12;
  task.start = 0;
  task.end = GRAPHDRL_AT_START;

  graphdrl_result* result = NULL;
  const graphdrl_status status = graphdrl_plan(world, &task, &result);
  const int exit_status = status == GRAPHDRL_DONE ? print_walk(result) : failed();
  graphdrl_free(result);
  graphdrl_free(world);
  return exit_status;
}
