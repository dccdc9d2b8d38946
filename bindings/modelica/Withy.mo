package Withy "Trees of rigid and flexible bodies, by the library withy-c"
  class Model "The equations of motion of a scene"
    extends ExternalObject;
    function constructor
      input String scene "file of the scene";
      input String formulation "empty: the scene's";
      input String inputs[:] "loads of the type input, in the order of u";
      output Model model;
      external "C" model = withy_modelica_open(scene, formulation, inputs, size(inputs, 1))
        annotation(Include = "#include \"withy_modelica.h\"", Library = "withy-c");
    end constructor;
    function destructor
      input Model model;
      external "C" withy_modelica_close(model)
        annotation(Include = "#include \"withy_modelica.h\"", Library = "withy-c");
    end destructor;
  end Model;

  function states "Number of states"
    input Model model;
    output Integer n;
    external "C" n = withy_modelica_states(model)
      annotation(Include = "#include \"withy_modelica.h\"", Library = "withy-c");
  end states;

  function begin "State at the begin of the scene"
    input Model model;
    input Integer n;
    output Real y[n];
    external "C" withy_modelica_initial(model, y, n)
      annotation(Include = "#include \"withy_modelica.h\"", Library = "withy-c");
  end begin;

  function derivatives "Time derivatives of positions and speeds"
    input Model model;
    input Real t;
    input Real y[:];
    input Real u[:];
    output Real y_dot[size(y, 1)];
    external "C" withy_modelica_derivatives(model, t, y, size(y, 1), u, size(u, 1), y_dot)
      annotation(Include = "#include \"withy_modelica.h\"", Library = "withy-c");
  end derivatives;

  block Plant "A scene, integrated by the Modelica tool"
    parameter String scene;
    parameter String formulation = "";
    parameter String inputs[:] = fill("", 0);
    parameter Integer n "number of states, known when the model is translated";
    input Real u[size(inputs, 1)] "efforts [N m, N]";
    output Real y[n] "positions, then speeds, as the result columns name them";
  protected
    Model model = Model(scene, formulation, inputs);
  initial equation
    assert(states(model) == n, "Withy.Plant: n must be the number of states of the scene");
    y = begin(model, n);
  equation
    der(y) = derivatives(model, time, y, u);
  end Plant;
end Withy;
