"""What data sheets say of valves beyond an overlap and an area: tables, load holding, a pump in a valve's place."""
